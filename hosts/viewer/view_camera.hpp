#pragma once
#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

namespace posefusion {

/// The user's viewpoint: orbiting around a point, or following behind the tracked camera.
/// The world is the first camera: x right, y DOWN, z forward; the viewing camera likewise.
class ViewCamera {
public:
    /// Angles in degrees: yaw to the right, pitch downwards.
    void orbit(float yaw_deg, float pitch_deg);
    /// Moves the point looked at, in units of the window's height at its distance, right and down.
    void pan(float right, float down);
    /// @param factor  on the distance; less than 1 = nearer
    void zoom(float factor);
    void follow(bool on) { follow_ = on; }
    [[nodiscard]] bool follows() const { return follow_; }
    /// Resets the view.
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
