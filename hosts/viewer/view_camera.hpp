#pragma once
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace posefusion {

/// From where the user looks at the map: around a point, or over the shoulder of the camera that is being tracked.
/// The world is the first camera: x right, y DOWN, z forward; the viewing camera likewise.
class ViewCamera {
public:
    /// Angles in degrees: yaw to the right, pitch downwards.
    void orbit(float yaw_deg, float pitch_deg);
    /// Shifts what is looked at, in units of the window's height at that distance, right and down.
    void pan(float right, float down);
    /// @param factor  on the distance; less than 1 = nearer
    void zoom(float factor);
    void follow(bool on) { follow_ = on; }
    [[nodiscard]] bool follows() const { return follow_; }
    /// As at the start.
    void home();

    /// World -> viewing camera. @param T_world_camera  pose of the tracked camera
    [[nodiscard]] glm::mat4 T_camera_world(const glm::mat4& T_world_camera) const;

private:
    float yaw_deg_ = 0, pitch_deg_ = 0;
    float distance_ = 0;  // metres
    glm::vec3 target_{0};
    bool follow_ = false;

public:
    ViewCamera() { home(); }
};

}  // namespace posefusion
