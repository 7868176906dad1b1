#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "hosts/synth/synth.hpp"

/// Rows of a rolling shutter, and depth that is late, show what a global shutter shows at their time.
namespace posefusion {
namespace {

constexpr int kRows = 24, kColumns = 32;
constexpr double kSeconds = 2;  // of both recordings, so that people do the same in them
constexpr double kFps = 30, kFineFps = 1000;
constexpr int kFrame = 45;
constexpr double kRowTime = 0.002;  // a row is read in

SynthConfig moving() {
    SynthConfig config;
    config.width = kColumns;
    config.height = kRows;
    config.people = 2;
    config.seed = 3;
    config.camera_speed = 4;
    config.noise = false;
    return config;
}

/// The middle of the image at the stamp, depth 15 ms after it.
const SynthWorld& rolling() {
    static const SynthWorld world = [] {
        SynthConfig config = moving();
        config.fps = kFps;
        config.frames = static_cast<int>(kSeconds * kFps);
        config.sensor.shutter.color_readout_ms = config.sensor.shutter.depth_readout_ms = 1e3f * kRows * kRowTime;
        config.sensor.stamped_delay_ms = 10;
        config.sensor.shutter.depth_delay_ms = 5;
        return SynthWorld(config);
    }();
    return world;
}

/// What a global shutter sees. @param seconds  after the frame's stamp
SynthFrame exact(double seconds) {
    static const SynthWorld world = [] {
        SynthConfig config = moving();
        config.fps = kFineFps;
        config.frames = static_cast<int>(kSeconds * kFineFps);
        return SynthWorld(config);
    }();
    return world.render(static_cast<int>(std::lround((kFrame / kFps + seconds) * kFineFps)));
}

double time_of(double row) { return (row + 0.5 - 0.5 * kRows) * kRowTime; }

TEST(SynthRollingShutter, RowsShowTheSceneAndThePeopleAtTheirTime) {
    const SynthFrame seen = rolling().render(kFrame), at_stamp = exact(0);
    EXPECT_NEAR(seen.depth_stamp - seen.stamp, 0.010, 1e-6);
    int pixels = 0, near = 0, grey = 0, labels = 0, moved = 0, people = 0;
    for (int v = 0; v < kRows; v += 3) {
        const SynthFrame color = exact(time_of(v)), depth = exact(time_of(v) + 0.015);
        for (int u = 0; u < kColumns; ++u) {
            ++pixels;
            near += std::abs(seen.depth(u, v) - depth.depth(u, v)) < 0.002f;
            moved += std::abs(seen.depth(u, v) - at_stamp.depth(u, v)) > 0.002f;
            grey += std::abs(seen.color(u, v).g - color.color(u, v).g) <= 3;
            labels += seen.labels(u, v) == color.labels(u, v);
            people += seen.labels(u, v) != 0;
        }
    }
    ASSERT_GT(people, pixels / 20) << "somebody is in view";
    EXPECT_GT(moved, pixels / 3) << "it would show if rows were all of one time";
    EXPECT_GT(near, pixels * 97 / 100);
    EXPECT_GT(grey, pixels * 94 / 100) << "soft shadows are drawn anew in each frame";
    EXPECT_GT(labels, pixels * 99 / 100);
}

TEST(SynthRollingShutter, JointsAreWhereTheRowShowsThem) {
    int compared = 0;
    for (const SynthPerson& person : rolling().render(kFrame).people)
        for (std::size_t j = 0; j < kJointCount; ++j) {
            const SynthJoint& joint = person.joints[j];
            if (joint.z <= 0 || joint.v < 0 || joint.v > kRows - 1) continue;
            const SynthFrame then = exact(time_of(std::round(static_cast<double>(joint.v))));
            const SynthJoint& truth = then.people[static_cast<std::size_t>(person.id) - 1].joints[j];
            EXPECT_NEAR(joint.u, truth.u, 0.1f);
            EXPECT_NEAR(joint.v, truth.v, 0.1f);
            if (++compared == 8) return;
        }
    FAIL() << "only " << compared << " joints in view";
}

}  // namespace
}  // namespace posefusion
