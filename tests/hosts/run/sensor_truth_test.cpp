#include <gtest/gtest.h>

#include "hosts/run/sensor_search.hpp"
#include "hosts/synth/synth.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

/// What a run finds out about a sensor is what the sensor does.
TEST(SensorTruth, ShutterAndDelayAreFound) {
    const test::TempFolder folder;
    SynthConfig made;
    made.out = folder / "recording";
    made.width = 240;
    made.height = 180;
    made.frames = 60;
    made.people = 0;
    made.camera_speed = 5;
    ShutterConfig& truth = made.sensor.shutter;
    truth.color_readout_ms = 26;
    truth.depth_readout_ms = 30;
    truth.depth_delay_ms = 12;
    synthesize(made);
    RunConfig config;
    config.no_people = true;
    const auto found = find_sensor_timing(
        made.out, config, [](std::size_t, std::size_t) {}, [] { return false; });
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(found->shutter.color_readout_ms, truth.color_readout_ms, 0.15f * truth.color_readout_ms);
    EXPECT_NEAR(found->shutter.depth_readout_ms, truth.depth_readout_ms, 0.15f * truth.depth_readout_ms);
    EXPECT_NEAR(found->shutter.depth_delay_ms, truth.depth_delay_ms, 3);
}

}  // namespace
}  // namespace posefusion
