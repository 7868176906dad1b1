#include "hosts/synth/camera_path.hpp"

namespace posefusion::synth {
namespace {

constexpr double kWanderHz = 0.10, kTremorHz = 2.2;
constexpr double kTremor = 0.0012;                  ///< metres
constexpr double kShake = 0.0022;                   ///< rad
constexpr double kRoll = 0.035;                     ///< rad
const Eigen::Vector3d kLookAbout(0.75, 0.0, 0.16);  ///< how far the point looked at wanders, metres

}  // namespace

CameraPath::CameraPath(const Room& room, std::uint64_t seed, double pace)
    : home_(room.camera_home.cast<double>()),
      target_(room.camera_target.cast<double>()),
      pace_(pace),
      x_(hash(seed, 1), kWanderHz),
      y_(hash(seed, 2), kWanderHz),
      z_(hash(seed, 3), kWanderHz),
      look_x_(hash(seed, 4), 0.9 * kWanderHz),
      look_z_(hash(seed, 5), kWanderHz),
      roll_(hash(seed, 6), kWanderHz),
      tremor_x_(hash(seed, 7), kTremorHz),
      tremor_y_(hash(seed, 8), kTremorHz),
      tremor_z_(hash(seed, 9), kTremorHz),
      shake_pan_(hash(seed, 10), kTremorHz),
      shake_tilt_(hash(seed, 11), kTremorHz),
      shake_roll_(hash(seed, 12), kTremorHz) {}

Eigen::Isometry3d CameraPath::at(double t) const {
    const double s = pace_ * t;
    const Eigen::Vector3d reach = 0.85 * kCameraSpace.cast<double>();  // the sines add up to at most 1.06
    const Eigen::Vector3d wander(reach.x() * x_(s), reach.y() * y_(s), reach.z() * z_(s));
    const Eigen::Vector3d tremor(tremor_x_(t), tremor_y_(t), tremor_z_(t));
    const Eigen::Vector3d position = home_ + wander + kTremor * tremor;
    const Eigen::Vector3d target = target_ + kLookAbout.cwiseProduct(Eigen::Vector3d(look_x_(s), 0, look_z_(s)));
    const Eigen::Vector3d forward = (target - home_ - wander).normalized();
    const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
    Eigen::Matrix3d look;
    look << right, forward.cross(right), forward;
    const Eigen::Matrix3d shake =
        (Eigen::AngleAxisd(kShake * shake_pan_(t), Eigen::Vector3d::UnitY()) *
         Eigen::AngleAxisd(kShake * shake_tilt_(t), Eigen::Vector3d::UnitX()) *
         Eigen::AngleAxisd(kRoll * roll_(s) + kShake * shake_roll_(t), Eigen::Vector3d::UnitZ()))
            .toRotationMatrix();
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = look * shake;
    pose.translation() = position;
    return pose;
}

}  // namespace posefusion::synth
