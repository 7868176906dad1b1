#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "hosts/run/calibration_search.hpp"
#include "hosts/run/sensor_search.hpp"
#include "hosts/synth/sensor_unit.hpp"
#include "hosts/synth/synth.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

/// A room without people, seen by a camera that moves so many times as fast as a calm hand.
SynthConfig empty_room(const test::TempFolder& folder, int frames, double speed) {
    SynthConfig made;
    made.out = folder / "recording";
    made.frames = frames;
    made.people = 0;
    made.camera_speed = speed;
    return made;
}

/// What a run finds out about a sensor is what the sensor does.
TEST(SensorTruth, ShutterAndDelayAreFound) {
    const test::TempFolder folder;
    SynthConfig made = empty_room(folder, 60, 5);
    made.width = 240;
    made.height = 180;
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

/// Found depth deformation against the true one over the image: root mean square of the difference, in parts of the
/// true one's.
double relative_error(const CameraParameters& found, const synth::DepthDistortion& truth, const Intrinsics& camera) {
    constexpr int kStep = 20;  // pixels
    double error = 0, size = 0;
    for (int v = 0; v < camera.height; v += kStep) {
        for (int u = 0; u < camera.width; u += kStep) {
            const DeformationCell cell = deformation_cell(u, v, camera.width, camera.height);
            double value = 0;
            for (std::size_t n = 0; n < cell.nodes.size(); ++n)
                value += cell.weights[n] * deformation_part(found)(static_cast<Eigen::Index>(cell.nodes[n]));
            const auto true_value = static_cast<double>(truth.at(static_cast<float>(u), static_cast<float>(v), camera));
            error += (value - true_value) * (value - true_value);
            size += true_value * true_value;
        }
    }
    return std::sqrt(error / size);
}

TEST(SensorTruth, CalibrationAndDeformationOfDepthAreFound) {
    const test::TempFolder folder;
    SynthConfig made = empty_room(folder, 90, 4);
    made.sensor.calibration.focal = 0.01f;
    made.sensor.calibration.principal = 3;
    made.sensor.depth_distortion.corner_least = made.sensor.depth_distortion.corner_most = 0.008f;
    synthesize(made);
    RunConfig config;
    config.no_people = true;
    config.sensor_timing = SensorTimingMode::Given;
    const auto found = find_calibration(
        made.out, config, {}, [](std::size_t, std::size_t) {}, [] { return false; });
    ASSERT_TRUE(found.has_value());
    EXPECT_TRUE(found->camera.has_value()) << "believed";
    const Intrinsics truth = read_camera_file(made.out / "camera_true.yaml").intrinsics;
    const Intrinsics estimate = intrinsics_of(found->calibration.estimate, truth.width, truth.height);
    EXPECT_NEAR(estimate.fx, truth.fx, 0.001f * truth.fx);
    EXPECT_NEAR(estimate.fy, truth.fy, 0.001f * truth.fy);
    EXPECT_NEAR(estimate.cx, truth.cx, 1);
    EXPECT_NEAR(estimate.cy, truth.cy, 1);
    const auto info = nlohmann::json::parse(std::ifstream(made.out / "info.json"));
    const auto& distortion = info.at("sensor").at("depth_distortion");
    const synth::DepthDistortion deformation{distortion.at("corner_per_m"), distortion.at("tilt_per_m"),
                                             distortion.at("still_radius2")};
    EXPECT_LT(relative_error(found->calibration.estimate, deformation, truth), 0.3);
}

}  // namespace
}  // namespace posefusion
