#include "hosts/viewer/view_camera.hpp"

#include <algorithm>
#include <numbers>

namespace posefusion {
namespace {

constexpr float kDegree = std::numbers::pi_v<float> / 180;
constexpr float kMaxPitch = 89 * kDegree;
constexpr float kMinDistance = 0.1f, kMaxDistance = 100;  // metres
// At the start: from behind and above the first camera, towards what it sees.
constexpr float kHomeYaw = -25 * kDegree, kHomePitch = 20 * kDegree, kHomeDistance = 4.5f;
const Eigen::Vector3f kHomeTarget{0, -0.1f, 2.0f};
// Over the shoulder: behind and above the tracked camera, metres.
const Eigen::Vector3f kShoulder{0, -0.5f, -1.2f};
constexpr float kShoulderPitch = 8 * kDegree;

Eigen::AngleAxisf about_y(float angle) { return {angle, Eigen::Vector3f::UnitY()}; }
/// y points down, so looking down turns the other way round.
Eigen::AngleAxisf downwards(float angle) { return {-angle, Eigen::Vector3f::UnitX()}; }

}  // namespace

void ViewCamera::home() {
    yaw_ = kHomeYaw, pitch_ = kHomePitch, distance_ = kHomeDistance;
    target_ = kHomeTarget;
}

void ViewCamera::orbit(float yaw_deg, float pitch_deg) {
    yaw_ += yaw_deg * kDegree;
    pitch_ = std::clamp(pitch_ + pitch_deg * kDegree, -kMaxPitch, kMaxPitch);
    follow_ = false;
}

void ViewCamera::pan(float right, float down) {
    target_ += about_y(yaw_) * downwards(pitch_) * Eigen::Vector3f(right, down, 0) * distance_;
    follow_ = false;
}

void ViewCamera::zoom(float factor) { distance_ = std::clamp(distance_ * factor, kMinDistance, kMaxDistance); }

Eigen::Isometry3f ViewCamera::T_camera_world(const Eigen::Isometry3f& T_world_camera) const {
    Eigen::Isometry3f T_world_view = Eigen::Isometry3f::Identity();
    if (follow_) {
        const float scale = distance_ / kHomeDistance;
        T_world_view = T_world_camera * Eigen::Translation3f(scale * kShoulder) * downwards(kShoulderPitch);
    } else {
        T_world_view.linear() = (about_y(yaw_) * downwards(pitch_)).toRotationMatrix();
        T_world_view.translation() = target_ - distance_ * T_world_view.linear().col(2);
    }
    return T_world_view.inverse();
}

}  // namespace posefusion
