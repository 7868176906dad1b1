#include "hosts/viewer/skeleton_3d.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace posefusion {
namespace {

constexpr int kWidth = 160, kHeight = 120;
const Intrinsics kCamera{130, 130, 79.5f, 59.5f, kWidth, kHeight};

/// A person 2 m away in a strip of the image, before a wall at 4 m.
struct Scene {
    DepthImage depth{kWidth, kHeight, 4.0f};
    LabelImage labels{kWidth, kHeight};
    People people{1};
    Scene() {
        for (int v = 20; v < 100; ++v) {
            for (int u = 70; u < 90; ++u) {
                depth(u, v) = 2;
                labels(u, v) = 1;
            }
        }
        people[0].joints[Neck] = {80, 30, 0.9f};
        people[0].joints[RightHip] = {75, 60, 0.9f};
        people[0].joints[RightKnee] = {75, 80, 0.9f};
    }
    [[nodiscard]] std::vector<Skeleton3d> lift(const Eigen::Isometry3f& pose = Eigen::Isometry3f::Identity()) const {
        return lift_joints(people, depth, labels, kCamera, pose);
    }
};

TEST(Skeleton3d, JointsLieWhereTheirRaysMeetTheBody) {
    const auto skeletons = Scene().lift();
    ASSERT_EQ(skeletons.size(), 1u);
    ASSERT_TRUE(skeletons[0][Neck]);
    const Eigen::Vector3f expected{(80 - 79.5f) / 130 * 2, (30 - 59.5f) / 130 * 2, 2};
    EXPECT_TRUE(skeletons[0][Neck]->isApprox(expected, 1e-5f)) << skeletons[0][Neck]->transpose();
    EXPECT_FALSE(skeletons[0][Nose]) << "was not found";
}

TEST(Skeleton3d, AreInTheWorld) {
    Eigen::Isometry3f pose = Eigen::Isometry3f::Identity();
    pose.linear() = Eigen::AngleAxisf(0.5f, Eigen::Vector3f::UnitY()).toRotationMatrix();
    pose.translation() = Eigen::Vector3f(1, 2, 3);
    const auto here = Scene().lift(), there = Scene().lift(pose);
    ASSERT_EQ(there.size(), 1u);
    EXPECT_TRUE(there[0][RightHip]->isApprox(pose * *here[0][RightHip], 1e-5f));
}

TEST(Skeleton3d, AJointAtTheEdgeTakesTheBodyNotTheWallBehind) {
    Scene scene;
    scene.people[0].joints[Neck] = {70, 30, 0.9f};  // half of its surroundings are wall
    const auto skeletons = scene.lift();
    ASSERT_TRUE(skeletons.at(0)[Neck]);
    EXPECT_FLOAT_EQ(skeletons[0][Neck]->z(), 2);
}

TEST(Skeleton3d, AJointFarBehindTheBodyIsLeftOut) {
    Scene scene;
    for (auto& label : scene.labels) label = 1;
    scene.people[0].joints[LeftWrist] = {20, 60, 0.9f};  // the network took the wall for a wrist
    const auto skeletons = scene.lift();
    ASSERT_EQ(skeletons.size(), 1u);
    EXPECT_FALSE(skeletons[0][LeftWrist]);
    EXPECT_TRUE(skeletons[0][RightKnee]);
}

TEST(Skeleton3d, WithoutDepthNobodyIsDrawn) {
    Scene scene;
    for (auto& z : scene.depth) z = 0;
    EXPECT_TRUE(scene.lift().empty());
}

TEST(Skeleton3d, JointsOutsideOfTheImageDoNoHarm) {
    Scene scene;
    const float odd[] = {
        -1e9f, 1e9f, -50, 5000, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()};
    int joint = RightShoulder;
    for (const float u : odd) scene.people[0].joints[static_cast<std::size_t>(joint++)] = {u, u, 0.9f};
    const auto skeletons = scene.lift();
    ASSERT_EQ(skeletons.size(), 1u);
    EXPECT_TRUE(skeletons[0][Neck]);
    EXPECT_FALSE(skeletons[0][RightShoulder]);
}

TEST(Skeleton3d, WithoutAMaskEveryPixelCounts) {
    Scene scene;
    const auto skeletons = lift_joints(scene.people, scene.depth, {}, kCamera, Eigen::Isometry3f::Identity());
    ASSERT_EQ(skeletons.size(), 1u);
    EXPECT_FLOAT_EQ(skeletons[0][RightHip]->z(), 2);
}

}  // namespace
}  // namespace posefusion
