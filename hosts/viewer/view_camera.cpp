#include "hosts/viewer/view_camera.hpp"

#include <algorithm>
#include <glm/ext/matrix_transform.hpp>
#include <glm/gtc/matrix_inverse.hpp>
#include <glm/trigonometric.hpp>

namespace posefusion {
namespace {

constexpr float kMaxPitchDeg = 89;
constexpr float kMinDistance = 0.1f, kMaxDistance = 100;  // metres
// At the start: from behind and above the first camera, towards what it sees.
constexpr float kHomeYawDeg = -25, kHomePitchDeg = 20, kHomeDistance = 4.5f;
constexpr glm::vec3 kHomeTarget{0, -0.1f, 2.0f};
// Over the shoulder: behind and above the tracked camera, metres.
constexpr glm::vec3 kShoulder{0, -0.5f, -1.2f};
constexpr float kShoulderPitchDeg = 8;

/// The axes of a camera with the given yaw (to the right of z) and pitch (below the horizon). y points down, so looking
/// down turns the other way round x.
glm::mat4 looking(float yaw_deg, float pitch_deg) {
    const glm::mat4 turned = glm::rotate(glm::mat4(1), glm::radians(yaw_deg), {0, 1, 0});
    return glm::rotate(turned, -glm::radians(pitch_deg), {1, 0, 0});
}

}  // namespace

void ViewCamera::home() {
    yaw_deg_ = kHomeYawDeg, pitch_deg_ = kHomePitchDeg, distance_ = kHomeDistance;
    target_ = kHomeTarget;
}

void ViewCamera::orbit(float yaw_deg, float pitch_deg) {
    yaw_deg_ += yaw_deg;
    pitch_deg_ = std::clamp(pitch_deg_ + pitch_deg, -kMaxPitchDeg, kMaxPitchDeg);
    follow_ = false;
}

void ViewCamera::pan(float right, float down) {
    target_ += glm::mat3(looking(yaw_deg_, pitch_deg_)) * glm::vec3(right, down, 0) * distance_;
    follow_ = false;
}

void ViewCamera::zoom(float factor) { distance_ = std::clamp(distance_ * factor, kMinDistance, kMaxDistance); }

glm::mat4 ViewCamera::T_camera_world(const glm::mat4& T_world_camera) const {
    glm::mat4 T_world_view;
    if (follow_) {
        T_world_view =
            glm::translate(T_world_camera, distance_ / kHomeDistance * kShoulder) * looking(0, kShoulderPitchDeg);
    } else {
        const glm::mat4 axes = looking(yaw_deg_, pitch_deg_);
        T_world_view = glm::translate(glm::mat4(1), target_ - distance_ * glm::vec3(axes[2])) * axes;
    }
    return glm::affineInverse(T_world_view);
}

}  // namespace posefusion
