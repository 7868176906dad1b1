#pragma once
#include "engine/preprocess/shutter_config.hpp"
#include "tests/engine/support/reference.hpp"
#include "tests/engine/support/synthetic_room.hpp"

/// Frames of a rolling shutter: each row of colour and depth seen from a pose of its own.
namespace posefusion::test {

/// A motion in the camera's frame, constant unless it turns faster and faster.
struct Velocity {
    Vector3d translation, rotation;            ///< m/s and rad/s
    Vector3d acceleration = Vector3d::Zero();  ///< of the turn, rad/s^2
    [[nodiscard]] Isometry3d after(double seconds) const {
        return exp_twist(seconds * translation, seconds * rotation + 0.5 * seconds * seconds * acceleration);
    }
};

/// Rows seen at the times that the configuration says, while the camera moves through T_world_camera.
[[nodiscard]] Frame render_rolling(const Intrinsics& camera, const ShutterConfig& shutter,
                                   const Isometry3d& T_world_camera, const Velocity& velocity);

/// Colour and depth at different times, the stamp not in the middle.
[[nodiscard]] ShutterConfig rolling_shutter();

}  // namespace posefusion::test
