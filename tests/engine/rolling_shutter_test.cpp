#include <algorithm>
#include <cmath>

#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/rolling_room.hpp"

// Tracking with a rolling shutter.
namespace posefusion::test {
namespace {

constexpr double kInterval = 1.0 / 30;  // seconds between frames

class RollingShutter : public SlamTest {};

/// Largest errors of the last poses of a camera that turns to and fro.
struct Drift {
    double translation = 0, degrees = 0;
};
Drift drift_of(const ShutterConfig& seen, const ShutterConfig& told) {
    SlamConfig config = test_config();
    config.shutter = told;
    Slam slam(kSmall, config, test_device());
    Drift drift;
    Isometry3d T = Isometry3d::Identity();
    for (int k = 0; k < 20; ++k) {
        // 45 degrees per second at most, changing smoothly
        const double pace = std::sin(0.3 * k);
        const Velocity velocity{{0.2 * pace, 0, 0.1 * pace}, {0.3 * pace, 0.75 * pace, -0.2 * pace}};
        if (k > 0) T = T * velocity.after(kInterval);
        const Frame frame = render_rolling(kSmall, seen, T, velocity);
        const FrameResult result = slam.process(frame.color, frame.depth, {}, {kInterval});
        EXPECT_TRUE(has_pose(result.tracking) || result.tracking == TrackingState::FirstFrame) << k;
        const Isometry3d error = T.inverse() * result.T_world_camera;
        drift.translation = std::max(drift.translation, error.translation().norm());
        drift.degrees = std::max(drift.degrees, angle_deg(error));
    }
    return drift;
}

TEST_F(RollingShutter, IsTrackedNearlyAsWellAsAGlobalOne) {
    const Drift ignored = drift_of(rolling_shutter(), {}), told = drift_of(rolling_shutter(), rolling_shutter());
    const Drift global = drift_of({}, {});
    EXPECT_GT(ignored.translation, 4 * told.translation);
    EXPECT_GT(ignored.degrees, 4 * told.degrees);
    EXPECT_LT(told.translation, global.translation + 0.002);
    EXPECT_LT(told.degrees, global.degrees + 0.08);
}

}  // namespace
}  // namespace posefusion::test
