#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/core/error.hpp"
#include "hosts/synth/synth.hpp"

/// What synth says about its pictures is what is in them.
namespace posefusion {
namespace {

SynthConfig small(int people) {
    SynthConfig config;
    config.width = 160;
    config.height = 120;
    config.people = people;
    config.frames = 90;
    config.seed = 11;
    return config;
}

Eigen::Vector3d back_project(const Intrinsics& k, int u, int v, float z) {
    return Eigen::Vector3d((u - static_cast<double>(k.cx)) / k.fx, (v - static_cast<double>(k.cy)) / k.fy, 1) *
           static_cast<double>(z);
}

/// Depth at a point between pixels, if the four around it lie on one plane; 1/z is linear over the image of a plane.
bool plane_depth(const DepthImage& depth, double u, double v, double& z) {
    const int x = static_cast<int>(std::floor(u)), y = static_cast<int>(std::floor(v));
    if (!depth.contains(x, y) || !depth.contains(x + 1, y + 1)) return false;
    const double a = 1 / depth(x, y), b = 1 / depth(x + 1, y), c = 1 / depth(x, y + 1), d = 1 / depth(x + 1, y + 1);
    if (std::abs(a + d - b - c) > 0.002 * a) return false;
    const double fx = u - x, fy = v - y;
    z = 1 / ((1 - fy) * ((1 - fx) * a + fx * b) + fy * ((1 - fx) * c + fx * d));
    return true;
}

TEST(SynthTruth, DepthOfOneFrameLandsOnTheDepthOfAnotherThroughTheTruePoses) {
    SynthConfig config = small(0);
    config.noise = false;
    const SynthWorld world(config);
    const SynthFrame a = world.render(0), b = world.render(45);
    const Eigen::Isometry3d T_b_a = b.T_world_camera.inverse() * a.T_world_camera;
    ASSERT_GT(T_b_a.translation().norm(), 0.05) << "the camera must have moved for this to say anything";
    const Intrinsics& k = world.camera();
    std::vector<double> errors;
    for (int v = 0; v < k.height; ++v)
        for (int u = 0; u < k.width; ++u) {
            const Eigen::Vector3d p = T_b_a * back_project(k, u, v, a.depth(u, v));
            double z = 0;
            if (p.z() > 0 && plane_depth(b.depth, k.fx * p.x() / p.z() + k.cx, k.fy * p.y() / p.z() + k.cy, z))
                errors.push_back(std::abs(z - p.z()));
        }
    ASSERT_GT(errors.size(), a.depth.size() / 3);
    std::nth_element(errors.begin(), errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2), errors.end());
    EXPECT_LT(errors[errors.size() / 2], 0.0001);
}

TEST(SynthTruth, LabelsMarkExactlyThePixelsWherePeopleStandBeforeTheRoom) {
    SynthConfig config = small(3);
    config.noise = false;
    SynthConfig empty = config;
    empty.people = 0;
    const SynthWorld with(config), without(empty);
    int labelled = 0;
    for (const int frame : {0, 40, 80}) {
        const SynthFrame a = with.render(frame), b = without.render(frame);
        ASSERT_TRUE(a.T_world_camera.isApprox(b.T_world_camera)) << "people must not move the camera";
        for (std::size_t i = 0; i < a.labels.size(); ++i) {
            if (a.labels[i] == 0) {
                EXPECT_EQ(a.depth[i], b.depth[i]);
            } else {
                EXPECT_LT(a.depth[i], b.depth[i]);
                ++labelled;
            }
        }
        for (const SynthPerson& person : a.people)
            EXPECT_EQ(person.pixels,
                      std::count(a.labels.begin(), a.labels.end(), static_cast<std::uint8_t>(person.id)));
    }
    EXPECT_GT(labelled, 500);
}

TEST(SynthTruth, VisibleJointsLieJustBelowTheSurfaceOfTheirPerson) {
    SynthConfig config = small(3);
    config.noise = false;
    const SynthWorld world(config);
    int visible = 0, hidden = 0;
    for (int frame = 0; frame < config.frames; frame += 15) {
        const SynthFrame f = world.render(frame);
        for (const SynthPerson& person : f.people)
            for (const SynthJoint& joint : person.joints) {
                if (joint.visibility == JointVisibility::Hidden) {
                    ++hidden;
                    continue;
                }
                const int u = static_cast<int>(std::lround(joint.u)), v = static_cast<int>(std::lround(joint.v));
                ASSERT_TRUE(f.labels.contains(u, v));
                EXPECT_EQ(f.labels(u, v), person.id);
                EXPECT_LT(f.depth(u, v), joint.z + 0.06f) << "the surface lies before the joint, or at it";
                if (joint.visibility != JointVisibility::Visible) continue;
                ++visible;
                EXPECT_GT(f.depth(u, v), joint.z - 0.25f);
            }
    }
    EXPECT_GT(visible, 30);
    EXPECT_GT(hidden, 10);
}

TEST(SynthTruth, SameConfigurationSamePixelsWhateverTheThreads) {
    SynthConfig config = small(2);
    config.threads = 1;
    const SynthFrame a = SynthWorld(config).render(7);
    config.threads = 3;
    const SynthWorld again(config);
    (void)again.render(2);  // what was rendered before must not matter
    const SynthFrame b = again.render(7);
    EXPECT_TRUE(std::equal(a.color.begin(), a.color.end(), b.color.begin()));
    EXPECT_TRUE(std::equal(a.depth.begin(), a.depth.end(), b.depth.begin()));
    EXPECT_TRUE(std::equal(a.labels.begin(), a.labels.end(), b.labels.begin()));
    for (std::size_t p = 0; p < a.people.size(); ++p)
        for (std::size_t j = 0; j < kJointCount; ++j) {
            EXPECT_EQ(a.people[p].joints[j].u, b.people[p].joints[j].u);
            EXPECT_EQ(a.people[p].joints[j].visibility, b.people[p].joints[j].visibility);
        }
    config.seed += 1;
    const SynthFrame other = SynthWorld(config).render(7);
    EXPECT_FALSE(std::equal(a.color.begin(), a.color.end(), other.color.begin()));
}

TEST(SynthTruth, RefusesConfigurationsOutOfRange) {
    const auto refused = [](auto change) {
        SynthConfig config = small(1);
        change(config);
        EXPECT_THROW(SynthWorld{config}, Error);
    };
    refused([](SynthConfig& c) { c.frames = 0; });
    refused([](SynthConfig& c) { c.people = -1; });
    refused([](SynthConfig& c) { c.people = kMaxSynthPeople + 1; });
    refused([](SynthConfig& c) { c.width = 0; });
    refused([](SynthConfig& c) { c.fps = 0; });
    refused([](SynthConfig& c) { c.camera_speed = std::nan(""); });
    refused([](SynthConfig& c) { c.threads = -2; });
}

}  // namespace
}  // namespace posefusion
