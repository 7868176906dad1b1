#include "hosts/synth/hand.hpp"

namespace posefusion::synth {
namespace {

constexpr double kTremorHz = 2.2;
constexpr double kTremor = 0.0012;  ///< metres
constexpr double kShake = 0.0022;   ///< rad

}  // namespace

Hand::Hand(std::uint64_t seed)
    : x_(hash(seed, 7), kTremorHz),
      y_(hash(seed, 8), kTremorHz),
      z_(hash(seed, 9), kTremorHz),
      pan_(hash(seed, 10), kTremorHz),
      tilt_(hash(seed, 11), kTremorHz),
      roll_(hash(seed, 12), kTremorHz) {}

Eigen::Isometry3d Hand::hold(const Eigen::Vector3d& position, const Eigen::Vector3d& forward, double roll,
                             double t) const {
    const Eigen::Vector3d tremor(x_(t), y_(t), z_(t));
    const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
    Eigen::Matrix3d look;
    look << right, forward.cross(right), forward;
    const Eigen::Matrix3d shake = (Eigen::AngleAxisd(kShake * pan_(t), Eigen::Vector3d::UnitY()) *
                                   Eigen::AngleAxisd(kShake * tilt_(t), Eigen::Vector3d::UnitX()) *
                                   Eigen::AngleAxisd(roll + kShake * roll_(t), Eigen::Vector3d::UnitZ()))
                                      .toRotationMatrix();
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = look * shake;
    pose.translation() = position + kTremor * tremor;
    return pose;
}

}  // namespace posefusion::synth
