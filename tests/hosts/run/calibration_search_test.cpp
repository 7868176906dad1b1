#include "hosts/run/calibration_search.hpp"

#include <gtest/gtest.h>

namespace posefusion {
namespace {

TEST(CalibrationSearch, IsOnlyMadeWhereItCanSaySomething) {
    const auto progress = [](std::size_t, std::size_t) { ADD_FAILURE() << "frames were looked at"; };
    const auto search = [&](const char* source, const RunConfig& config) {
        return find_calibration(source, config, {}, progress, [] { return false; });
    };
    RunConfig config;
    EXPECT_FALSE(search("openni2:", config)) << "a camera's frames come once";
    config.sensor_calibration = SensorCalibrationMode::Given;
    EXPECT_FALSE(search("no/such/recording", config)) << "as given";
}

TEST(CalibrationSearch, WhatWasCorrectedIsSaidInItsUnits) {
    FoundCalibration found;
    Calibration& c = found.calibration;
    c.given = c.believed = parameters_of({500, 500, 320, 240, 640, 480}, {});
    c.believed(0) = 505, c.believed(1) = 497.5, c.believed(2) = 322, c.believed(3) = 239.5;
    c.intrinsics = true;
    EXPECT_EQ(calibration_change(found), "fx +1.00 %, fy -0.50 %, cx +2.0 px, cy -0.5 px");
    c.believed(kIntrinsicParameters + 3) = -0.005;
    c.deformation = true;
    EXPECT_NE(calibration_change(found).find("depth at 2 m by up to 2.0 cm"), std::string::npos);
    found.shutter.color_readout_ms = 26, found.shutter.depth_readout_ms = 30.5f;
    c.times = true;
    EXPECT_NE(calibration_change(found).find(", rows of colour in 26.0 ms, of depth in 30.5 ms"), std::string::npos);
}

}  // namespace
}  // namespace posefusion
