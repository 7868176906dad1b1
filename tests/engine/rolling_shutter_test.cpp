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
    // how the camera turns at the stamp is estimated from so few pixels that it costs a little, where it turns evenly
    EXPECT_GT(ignored.translation, 4 * told.translation);
    EXPECT_GT(ignored.degrees, 2.5 * told.degrees);
    EXPECT_LT(told.translation, global.translation + 0.003);
    EXPECT_LT(told.degrees, global.degrees + 0.12);
}

/// What a run that looks for it says about the shutter. @param told  what it corrects
SensorTiming::Estimate timing_of(const ShutterConfig& seen, const ShutterConfig& told) {
    SlamConfig config = test_config();
    config.shutter = told;
    config.estimate_timing = true;
    Slam slam(kSmall, config, test_device());
    Isometry3d T = Isometry3d::Identity();
    for (int k = 0; k < 60; ++k) {
        const Velocity velocity{{0.2 * std::sin(0.3 * k), 0.1 * std::sin(0.17 * k), 0.1 * std::cos(0.23 * k)},
                                {0.3 * std::sin(0.21 * k), 0.6 * std::sin(0.3 * k), -0.2 * std::cos(0.27 * k)}};
        if (k > 0) T = T * velocity.after(kInterval);
        const Frame frame = render_rolling(kSmall, seen, T, velocity);
        const FrameResult result = slam.process(frame.color, frame.depth, {}, {kInterval});
        EXPECT_TRUE(has_pose(result.tracking)) << k;
    }
    return slam.sensor_timing();
}

TEST_F(RollingShutter, IsFoundByItself) {
    const ShutterConfig truth = rolling_shutter();
    ShutterConfig told;
    told.stamp_row = truth.stamp_row;
    SensorTiming::Estimate found;
    for (int look = 0; look < 2; ++look) {  // as the search before a run does
        found = timing_of(truth, told);
        told.depth_delay_ms = static_cast<float>(1e3 * found.times(0));
        told.depth_readout_ms = static_cast<float>(1e3 * found.times(1));
        told.color_readout_ms = static_cast<float>(1e3 * found.times(2));
    }
    EXPECT_NEAR(told.depth_delay_ms, truth.depth_delay_ms, 3);
    EXPECT_NEAR(told.depth_readout_ms, truth.depth_readout_ms, 0.15f * truth.depth_readout_ms);
    EXPECT_NEAR(told.color_readout_ms, truth.color_readout_ms, 0.15f * truth.color_readout_ms);
}

TEST_F(RollingShutter, IsNotFoundWhereThereIsNone) {
    const SensorTiming::Estimate found = timing_of({}, {});
    for (int t = 0; t < 3; ++t) EXPECT_LT(std::abs(found.times(t)), 0.003) << t;
}

}  // namespace
}  // namespace posefusion::test
