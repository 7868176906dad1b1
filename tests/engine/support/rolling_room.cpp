#include "tests/engine/support/rolling_room.hpp"

namespace posefusion::test {

Frame render_rolling(const Intrinsics& camera, const ShutterConfig& shutter, const Isometry3d& T_world_camera,
                     const Velocity& velocity) {
    Frame frame{ColorImage(camera.width, camera.height), DepthImage(camera.width, camera.height), {}};
    for (int v = 0; v < camera.height; ++v) {
        const auto time = [&](float readout_ms) {
            return 1e-3 * readout_ms * ((v + 0.5) / camera.height - static_cast<double>(shutter.stamp_row));
        };
        const double color_time = time(shutter.color_readout_ms);
        const double depth_time = time(shutter.depth_readout_ms) + 1e-3 * shutter.depth_delay_ms;
        // one row, as an image of its own
        Intrinsics row = camera;
        row.height = 1;
        row.cy = camera.cy - static_cast<float>(v);
        const Frame color = render_room(row, T_world_camera * velocity.after(color_time));
        const Frame depth = render_room(row, T_world_camera * velocity.after(depth_time));
        for (int u = 0; u < camera.width; ++u) {
            frame.color(u, v) = color.color(u, 0);
            frame.depth(u, v) = depth.depth(u, 0);
        }
    }
    return frame;
}

ShutterConfig rolling_shutter() {
    ShutterConfig shutter;
    shutter.color_readout_ms = 26;
    shutter.depth_readout_ms = 30;
    shutter.stamp_row = 0.25f;
    shutter.depth_delay_ms = 8;
    return shutter;
}

}  // namespace posefusion::test
