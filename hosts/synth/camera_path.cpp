#include "hosts/synth/camera_path.hpp"

namespace posefusion::synth {
namespace {

constexpr double kWanderHz = 0.10;
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
      hand_(seed) {}

Eigen::Isometry3d CameraPath::at(double t) const {
    const double s = pace_ * t;
    const Eigen::Vector3d reach = 0.85 * kCameraSpace.cast<double>();  // the sines add up to at most 1.06
    const Eigen::Vector3d wander(reach.x() * x_(s), reach.y() * y_(s), reach.z() * z_(s));
    const Eigen::Vector3d target = target_ + kLookAbout.cwiseProduct(Eigen::Vector3d(look_x_(s), 0, look_z_(s)));
    return hand_.hold(home_ + wander, (target - home_ - wander).normalized(), kRoll * roll_(s), t);
}

}  // namespace posefusion::synth
