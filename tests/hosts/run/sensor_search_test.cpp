#include "hosts/run/sensor_search.hpp"

#include <gtest/gtest.h>

namespace posefusion {
namespace {

SensorTiming::Estimate estimate_of(double delay_ms, double depth_ms, double color_ms, double sigma_ms) {
    return {SensorTimes(delay_ms, depth_ms, color_ms) * 1e-3, SensorTimes::Constant(sigma_ms * 1e-3), 100};
}

TEST(SensorSearch, WhatIsCertainIsBelievedInTenthsOfAMillisecond) {
    ShutterConfig assumed;
    assumed.stamp_row = 1;
    const ShutterConfig found = believed(estimate_of(-12.34, 27.56, 25.96, 1), assumed);
    EXPECT_FLOAT_EQ(found.depth_delay_ms, -12.3f);
    EXPECT_FLOAT_EQ(found.depth_readout_ms, 27.6f);
    EXPECT_FLOAT_EQ(found.color_readout_ms, 26);
    EXPECT_EQ(found.stamp_row, 1) << "is not looked for";
}

TEST(SensorSearch, WhatIsUncertainOrSmallIsNot) {
    EXPECT_TRUE(believed(estimate_of(0, 0, 0, 1), {}).is_global());
    EXPECT_TRUE(believed(estimate_of(2.9, 9.9, 9.9, 0.1), {}).is_global()) << "small";
    EXPECT_TRUE(believed(estimate_of(12, 28, 26, 7), {}).is_global()) << "uncertain";
    const ShutterConfig depth_is_global = believed(estimate_of(0.5, 1, 20, 1), {});
    EXPECT_EQ(depth_is_global.depth_readout_ms, 0);
    EXPECT_FLOAT_EQ(depth_is_global.color_readout_ms, 20);
}

TEST(SensorSearch, NoShutterRollsBackwardsOrForLongerThanThereIsTime) {
    const ShutterConfig found = believed(estimate_of(-50, -20, 60, 1), {});
    EXPECT_EQ(found.depth_readout_ms, 0);
    EXPECT_LT(found.color_readout_ms, 34);
    EXPECT_FLOAT_EQ(found.depth_delay_ms, -20);
}

TEST(SensorSearch, WhatIsGivenIsNotLookedFor) {
    const auto progress = [](std::size_t, std::size_t) { ADD_FAILURE() << "frames were looked at"; };
    const auto search = [&](const char* source, const RunConfig& config) {
        return find_sensor_timing(source, config, progress, [] { return false; });
    };
    RunConfig config;
    EXPECT_FALSE(search("openni2:", config)) << "a camera's frames come once";
    config.sensor_timing = SensorTimingMode::Given;
    EXPECT_FALSE(search("no/such/recording", config));
    config.sensor_timing = SensorTimingMode::Auto;
    config.slam.shutter.color_readout_ms = 20;
    EXPECT_FALSE(search("no/such/recording", config));
}

}  // namespace
}  // namespace posefusion
