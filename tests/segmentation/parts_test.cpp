#include <gtest/gtest.h>

#include <cmath>

#include "segmentation/body_volume.hpp"
#include "segmentation/grid_cut.hpp"
#include "segmentation/mask_memory.hpp"
#include "segmentation/skeleton.hpp"
#include "segmentation/support_planes.hpp"
#include "tests/segmentation/scene.hpp"

namespace posefusion {
namespace {

using Eigen::Vector3f;

TEST(Skeleton, JointsLieInTheBodyAtTheirTrueDepth) {
    const Intrinsics camera = test::camera_of(320, 240);
    const test::Frame frame = test::render({.people = {{0.0f, 3.2f}}}, camera);
    const auto skeleton = lift_skeleton(frame.people[0], frame.depth, camera, {});
    ASSERT_TRUE(skeleton);
    for (const int j : {Neck, RightShoulder, LeftHip, RightKnee, LeftElbow}) {
        EXPECT_EQ(skeleton->source[j], JointSource::Measured) << j;
        EXPECT_NEAR(skeleton->joint[j].z(), 3.2f, 0.06f) << j;
    }
}

TEST(Skeleton, JointsBehindFurnitureAreInferredAndNameWhatHidesThem) {
    const Intrinsics camera = test::camera_of(320, 240);
    const test::Frame frame =
        test::render({.people = {{0.0f, 3.0f}}, .boxes = {{{-0.8f, 0.55f, 2.2f}, {0.8f, test::kFloor, 2.6f}}}}, camera);
    const auto skeleton = lift_skeleton(frame.people[0], frame.depth, camera, {});
    ASSERT_TRUE(skeleton);
    EXPECT_EQ(skeleton->source[RightKnee], JointSource::Inferred);
    EXPECT_NEAR(skeleton->joint[RightKnee].z(), 3.0f, 0.15f);
    ASSERT_FALSE(skeleton->occluders.empty());
    for (const Vector3f& point : skeleton->occluders) EXPECT_NEAR(point.z(), 2.4f, 0.25f);
}

TEST(Skeleton, WithoutDepthThereIsNone) {
    const Intrinsics camera = test::camera_of(160, 120);
    const test::Frame frame = test::render({.people = {{0.0f, 3.2f}}}, camera);
    EXPECT_FALSE(lift_skeleton(frame.people[0], DepthImage(160, 120), camera, {}));
    EXPECT_FALSE(lift_skeleton(Person{}, frame.depth, camera, {}));
}

TEST(BodyVolume, DistanceIsNegativeInsideAndMetricOutside) {
    Skeleton skeleton;
    for (const int j : {RightShoulder, RightElbow}) skeleton.source[j] = JointSource::Measured;
    skeleton.joint[RightShoulder] = {0, 0, 2};
    skeleton.joint[RightElbow] = {0, 0.3f, 2};
    const BodyVolume body(skeleton);
    EXPECT_LT(body.distance({0, 0.15f, 2}), 0);
    const float near = body.distance({0.2f, 0.15f, 2}), far = body.distance({0.5f, 0.15f, 2});
    EXPECT_GT(near, 0.1f);
    EXPECT_NEAR(far - near, 0.3f, 1e-5f);
    // Seen from the front the outline is as far away as the body is.
    const Intrinsics camera = test::camera_of(640, 480);
    EXPECT_NEAR(body.outline_distance(camera.cx + camera.fx * 0.25f, camera.cy + camera.fy * 0.075f, camera), far,
                1e-3f);
}

TEST(GridCut, CutsAtTheDepthStepAndNowhereElse) {
    const Intrinsics camera = test::camera_of(64, 48);
    DepthImage depth(64, 48, 2.0f);
    for (int v = 0; v < 48; ++v)
        for (int u = 0; u < 32; ++u) depth(u, v) = 1.5f;
    const NodeGrid grid = make_node_grid(ColorImage(64, 48), depth, camera, {}, 2);
    std::vector<float> preference(grid.nodes.size(), -0.001f);
    preference[grid.index(3, 12)] = 100;
    preference[grid.index(28, 12)] = -100;
    const auto labels = cut_grid(grid, preference, {});
    for (int y = 0; y < grid.height; ++y)
        for (int x = 0; x < grid.width; ++x) ASSERT_EQ(labels[grid.index(x, y)], x < 16) << x << " " << y;
}

// A column of edges that cross a step costs nothing, so the cut follows it; where noise explains the step it costs more
// than a way round the one node that is surely a person.
TEST(GridCut, AStepThatTheNoiseOfTheCameraExplainsIsNoBorder) {
    const Intrinsics camera = test::camera_of(64, 48);
    DepthImage depth(64, 48, 2.0f);
    for (int v = 0; v < 48; ++v)
        for (int u = 0; u < 32; ++u) depth(u, v) = 1.9f;
    const auto people = [&](const DepthNoise& noise) {
        const NodeGrid grid = make_node_grid(ColorImage(64, 48), depth, camera, noise, 2);
        std::vector<float> preference(grid.nodes.size(), -0.001f);
        preference[grid.index(3, 12)] = 100;
        preference[grid.index(28, 12)] = -100;
        const auto labels = cut_grid(grid, preference, {});
        return std::count(labels.begin(), labels.end(), 1);
    };
    EXPECT_EQ(people({}), 16 * 24);
    EXPECT_EQ(people({.a = 0.1f}), 1);
}

TEST(SupportPlanes, FindsTheFloorOfARoomAndNotTheWall) {
    const Intrinsics camera = test::camera_of(320, 240);
    const test::Frame frame = test::render({}, camera);
    const NodeGrid grid = make_node_grid(frame.color, frame.depth, camera, {}, 2);
    const auto planes = find_support_planes(grid, std::vector<bool>(grid.nodes.size(), true), {});
    ASSERT_EQ(planes.size(), 1u);
    EXPECT_NEAR(planes[0].normal.y(), -1, 0.001f);
    EXPECT_NEAR(planes[0].offset, -test::kFloor, 0.01f);
    EXPECT_NEAR(planes[0].height({0, test::kFloor - 0.3f, 2}), 0.3f, 0.02f);
}

TEST(MaskMemory, ReturnsStaticSurfaceBehindAPersonAfterTheCameraMoved) {
    const Intrinsics camera = test::camera_of(160, 120);
    const Vector3f motion(0.1f, 0, 0.2f);
    MaskMemory memory({});
    const test::Frame empty = test::render({}, camera);
    const NodeGrid before = make_node_grid(empty.color, empty.depth, camera, {}, 1);
    const auto stays = [](int) -> Vector3f { return Vector3f::Zero(); };
    (void)memory.recall(before, Eigen::Isometry3f::Identity(), stays);
    memory.remember(before, std::vector<int>(before.nodes.size(), 0));

    const test::Frame later = test::render({.people = {{0.0f, 2.5f}}, .camera = motion}, camera);
    const test::Frame truth = test::render({.camera = motion}, camera);
    const NodeGrid after = make_node_grid(later.color, later.depth, camera, {}, 1);
    Eigen::Isometry3f T_current_previous = Eigen::Isometry3f::Identity();
    T_current_previous.translation() = -motion;
    const auto remembered = memory.recall(after, T_current_previous, stays);
    int checked = 0;
    for (std::size_t i = 0; i < remembered.size(); ++i) {
        if (!later.truth[i] || remembered[i].static_depth <= 0) continue;
        EXPECT_NEAR(remembered[i].static_depth, truth.depth[i], 0.15f);
        ++checked;
    }
    EXPECT_GT(checked, 500);
}

}  // namespace
}  // namespace posefusion
