#include "hosts/synth/sensor_unit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "engine/core/error.hpp"
#include "hosts/io/recording.hpp"
#include "hosts/io/text_file.hpp"
#include "hosts/synth/exposure_course.hpp"
#include "hosts/synth/synth.hpp"
#include "tests/hosts/support/temp_folder.hpp"

/// What a sensor does is what its model and info.json say.
namespace posefusion {
namespace {

SynthConfig small(const char* sensor) {
    SynthConfig config;
    config.width = 64;
    config.height = 48;
    config.people = 1;
    config.frames = 3;
    config.seed = 9;
    config.sensor = synth::sensor_model(sensor);
    return config;
}

TEST(SynthSensorUnit, SamePixelsWhateverTheThreads) {
    SynthConfig config = small("tof");
    const synth::DepthSensorModel& stereo = synth::sensor_model("realsense").depth;  // and all that it does
    synth::DepthSensorModel& depth = config.sensor.depth;
    depth.baseline = stereo.baseline, depth.disparity_step = stereo.disparity_step;
    depth.weak_contrast = stereo.weak_contrast, depth.weak_noise = stereo.weak_noise;
    depth.hole_sigmas = stereo.hole_sigmas, depth.weak_hole_sigmas = stereo.weak_hole_sigmas;
    config.threads = 1;
    const SynthFrame a = SynthWorld(config).render(2);
    config.threads = 3;
    const SynthWorld again(config);
    (void)again.render(0);  // what was rendered before must not matter
    const SynthFrame b = again.render(2);
    EXPECT_TRUE(std::equal(a.color.begin(), a.color.end(), b.color.begin()));
    EXPECT_TRUE(std::equal(a.depth.begin(), a.depth.end(), b.depth.begin()));
    EXPECT_TRUE(std::equal(a.labels.begin(), a.labels.end(), b.labels.begin()));
    EXPECT_EQ(a.gain, b.gain);
}

TEST(SynthSensorUnit, KindsHaveNames) {
    EXPECT_TRUE(SynthConfig{}.sensor.perfect());
    EXPECT_STREQ(synth::sensor_models().front().name, "clean");
    for (const synth::SensorModel& model : synth::sensor_models()) {
        EXPECT_EQ(&synth::sensor_model(model.name), &model);
        EXPECT_EQ(model.perfect(), &model == &synth::sensor_models().front()) << model.name;
    }
    EXPECT_THROW((void)synth::sensor_model("polaroid"), Error);
}

TEST(SynthSensorUnit, UnitsDifferWithinTheirTolerance) {
    const synth::SensorModel& model = synth::sensor_model("kinect");
    const Intrinsics nominal{535, 535, 319.5f, 239.5f, 640, 480};
    float largest = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        const synth::SensorUnit unit(model, nominal, 5000, seed);
        const Intrinsics &truth = unit.camera().intrinsics, &believed = unit.calibration().intrinsics;
        EXPECT_EQ(truth, nominal);
        EXPECT_LE(std::abs(believed.fx / truth.fx - 1), model.calibration.focal + 1e-6f);
        EXPECT_LE(std::abs(believed.cy - truth.cy), model.calibration.principal + 1e-4f);
        largest = std::max(largest, std::abs(believed.fx / truth.fx - 1));
        EXPECT_GE(std::abs(unit.depth_distortion().corner), model.depth_distortion.corner_least);
        EXPECT_LE(std::abs(unit.depth_distortion().corner), model.depth_distortion.corner_most);
        EXPECT_NE(unit.calibration().distortion, unit.camera().distortion);
    }
    EXPECT_GT(largest, 0.5f * model.calibration.focal);
}

TEST(SynthSensorUnit, RaysAndProjectionThroughTheLensAreInverse) {
    const synth::SensorUnit unit(synth::sensor_model("kinect"), {535, 535, 319.5f, 239.5f, 640, 480}, 5000, 1);
    for (const float u : {0.0f, 100.0f, 639.0f})
        for (const float v : {0.0f, 300.0f, 479.0f}) {
            const Eigen::Vector2f back = unit.project(2.5f * unit.ray(u, v));
            EXPECT_NEAR(back.x(), u, 0.02f);
            EXPECT_NEAR(back.y(), v, 0.02f);
        }
}

/// An empty room as it is, and through a sensor of which depth and brightness are changed, but neither noise nor time.
struct Views {
    SynthWorld changed_world;
    SynthFrame exact, changed;
};
const Views& views() {
    static const Views views = [] {
        SynthConfig config = small("clean");
        config.people = 0;
        config.noise = false;
        SynthConfig changed = config;
        changed.sensor.depth_distortion = synth::sensor_model("hardened").depth_distortion;
        changed.sensor.exposure.wander_ev = 0.5f;
        changed.sensor.exposure.vignetting_ev = 1;
        SynthWorld world(changed);
        SynthFrame frame = world.render(0);
        return Views{std::move(world), SynthWorld(config).render(0), std::move(frame)};
    }();
    return views;
}

TEST(SynthSensorUnit, DepthIsDistortedAsInfoSays) {
    const auto& [world, exact, changed] = views();
    const synth::DepthDistortion& d = world.sensor().depth_distortion();
    ASSERT_GT(std::abs(d.corner), 0.002f);
    const Intrinsics& k = world.camera();
    const float half_width = 0.5f * static_cast<float>(k.width), half_height = 0.5f * static_cast<float>(k.height);
    for (int v = 0; v < k.height; ++v)
        for (int u = 0; u < k.width; ++u) {
            const float x = static_cast<float>(u) - k.cx, y = static_cast<float>(v) - k.cy;
            const float r2 = (x * x + y * y) / (half_width * half_width + half_height * half_height);
            const float c = d.corner * (r2 - d.still_radius2) + d.tilt * x / half_width;
            ASSERT_NEAR(1 / changed.depth(u, v), 1 / exact.depth(u, v) - c, 1e-5f);
        }
}

TEST(SynthSensorUnit, RecordingHasTheCalibrationOfTheFactoryAndTheTruthBesideIt) {
    const test::TempFolder folder;
    SynthConfig config = small("kinect");
    config.out = folder / "made";
    synthesize(config);
    const auto truth = nlohmann::json::parse(read_text_file(config.out / "info.json", 1 << 20)).at("sensor");
    EXPECT_EQ(truth.at("name"), "kinect");
    EXPECT_EQ(truth.at("color_readout_ms"), 26);
    EXPECT_EQ(truth.at("gains").size(), 3u);
    const Camera believed = read_camera_file(config.out / "camera.yaml");
    const Camera exact = read_camera_file(config.out / "camera_true.yaml");
    EXPECT_EQ(truth.at("camera_true").at("fx"), exact.intrinsics.fx);
    EXPECT_EQ(truth.at("camera_calibrated").at("fx"), believed.intrinsics.fx);
    EXPECT_NE(believed.intrinsics.fx, exact.intrinsics.fx);
    const Recording recording(config.out);
    EXPECT_TRUE(recording.warnings().empty());
    const double middle = 1e-3 * config.sensor.stamped_delay_ms, most = 1.1e-3 * config.sensor.stamped_wander_ms;
    double before = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const double delay = to_seconds(recording.load(i).depth_delay);
        EXPECT_NEAR(delay, middle, most);
        EXPECT_NE(delay, before) << "the streams drift against each other";
        before = delay;
    }
}

TEST(SynthExposure, FollowsTheBrightnessOfTheViewWithALag) {
    synth::ExposureControl control;
    control.follow = 1;
    control.lag_s = 0.5f;
    constexpr int kStep = 10;
    std::vector<float> brightness(100, 0.4f);
    std::fill(brightness.begin() + kStep, brightness.end(), 0.2f);  // half as bright from here on
    const synth::ExposureCourse course(control, brightness, 30, 1);
    EXPECT_FLOAT_EQ(course.gain(kStep), 1) << "a frame's own brightness comes too late for it";
    EXPECT_NEAR(std::log2(course.gain(kStep + 15)), 1 - std::exp(-1), 0.01) << "after the lag";
    EXPECT_NEAR(course.gain(99), 2, 0.02);
    EXPECT_EQ(course.channels(50), Eigen::Vector3f::Constant(course.gain(50)));
}

TEST(SynthExposure, GainAndVignettingAreThoseOfLinearLight) {
    const auto& [world, fixed, changed] = views();
    ASSERT_GT(std::abs(std::log2(changed.gain.y())), 0.02f);
    const auto linear = [](std::uint8_t grey) { return std::pow((grey / 255.0 + 0.055) / 1.055, 2.4); };
    const auto ratio = [&fixed = fixed, &changed = changed, &linear](int u0, int v0) {
        double before = 0, after = 0;
        for (int v = v0; v < v0 + 6; ++v)
            for (int u = u0; u < u0 + 6; ++u) {
                if (std::max(fixed.color(u, v).g, changed.color(u, v).g) > 250) continue;
                before += linear(fixed.color(u, v).g), after += linear(changed.color(u, v).g);
            }
        return after / before / static_cast<double>(changed.gain.y());
    };
    EXPECT_NEAR(ratio(29, 21), 1, 0.05) << "in the middle";
    EXPECT_NEAR(ratio(0, 42), 0.56, 0.05) << "in a corner";
}

}  // namespace
}  // namespace posefusion
