#include "hosts/viewer/shown_objects.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "hosts/viewer/scene_lines.hpp"

namespace posefusion {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Eigen::Vector3f;

Isometry3d at(double x, double y, double z) { return Isometry3d(Eigen::Translation3d(x, y, z)); }

/// The camera goes up by a metre per frame.
FrameNews frame(std::size_t number, std::vector<MovingObject> objects) {
    FrameNews news;
    news.number = number;
    news.stamp = std::chrono::milliseconds(1000 + 100 * number);
    news.T_world_camera = at(0, static_cast<double>(number), 0);
    news.result.tracking = number == 0 ? TrackingState::FirstFrame : TrackingState::Ok;
    news.result.objects = std::move(objects);
    return news;
}

/// 101 in frames 1, 2 and 5, 104 in frame 2; both two metres before the camera.
ShownObjects some() {
    ShownObjects objects;
    objects.add(frame(0, {}));
    objects.add(frame(1, {{101, at(0, 0, 2), 50}}));
    objects.add(frame(2, {{101, at(0.5, 0, 2), 60}, {104, at(1, 0, 2), 70}}));
    objects.add(frame(3, {}));
    objects.add(frame(4, {}));
    objects.add(frame(5, {{101, at(1, 0, 2), 80}}));
    return objects;
}

TEST(ShownObjects, HavePathsInTheWorldWithGaps) {
    const ShownObjects objects = some();
    ASSERT_EQ(objects.all().size(), 2u);
    const ShownObject &first = objects.all()[0], &second = objects.all()[1];
    EXPECT_EQ(first.label, 101);
    EXPECT_EQ(first.frames, 3u);
    EXPECT_EQ(first.pixels, 80u);
    ASSERT_EQ(first.path.size(), 4u);
    EXPECT_EQ(first.path[1], Vector3f(0.5f, 2, 2));
    EXPECT_FALSE(first.path[2].allFinite());
    EXPECT_EQ(first.path[3], Vector3f(1, 5, 2));
    ASSERT_TRUE(first.T_world_object);
    EXPECT_EQ(first.T_world_object->translation(), Vector3f(1, 5, 2));
    EXPECT_EQ(second.label, 104);
    EXPECT_FALSE(second.T_world_object) << "not tracked in the newest frame";
    EXPECT_EQ(second.pixels, 0u);

    std::vector<Segment> lines;
    add_object_paths(lines, objects.all());
    EXPECT_EQ(lines.size(), 3u) << "two starts, and one line: none across the gap";
    EXPECT_NE(lines[0].color, lines[2].color);
}

TEST(ShownObjects, FollowTheCameraWhenItsPosesAreCorrected) {
    ShownObjects objects = some();
    Trajectory poses;  // frame 1 is no longer in the world of the map
    for (const std::size_t i : {0u, 2u, 3u, 4u, 5u})
        poses.push_back({std::chrono::milliseconds(1000 + 100 * i), at(10, 0, 0)});
    objects.correct(poses);
    const std::vector<Vector3f>& path = objects.all()[0].path;
    ASSERT_EQ(path.size(), 3u);
    EXPECT_EQ(path[0], Vector3f(10.5f, 0, 2));
    EXPECT_EQ(path[2], Vector3f(11, 0, 2));
    objects.add(frame(6, {{101, at(2, 0, 2), 1}}));
    ASSERT_EQ(objects.all()[0].path.size(), 4u) << "no gap after the last frame";
    EXPECT_EQ(objects.all()[0].path[3], Vector3f(2, 6, 2));
}

TEST(ShownObjects, AFrameWithoutAPoseShowsNone) {
    ShownObjects objects = some();
    FrameNews lost = frame(6, {{101, at(2, 0, 2), 1}});
    lost.result.tracking = TrackingState::Failed;
    objects.add(lost);
    EXPECT_FALSE(objects.all()[0].T_world_object);
    EXPECT_EQ(objects.all()[0].frames, 3u);
}

TEST(ShownObjects, ModelsStandWhereTheObjectsAreNow) {
    ShownObjects objects = some();
    Surfel surfel;
    surfel.normal = {0, 0, -1};
    surfel.position = {0, 0, 0.1f};
    surfel.created = 0, surfel.last_seen = 2;  // of the three frames in which it was fused
    Surfel older = surfel;
    older.last_seen = 1;
    objects.set_models({{101, {surfel, older}}, {104, {surfel}}});
    const std::vector<Surfel> shown = objects.surfels();
    ASSERT_EQ(shown.size(), 2u) << "the other one is not tracked now";
    EXPECT_EQ(shown[0].position, Vector3f(1, 5, 2.1f));
    EXPECT_EQ(shown[0].last_seen, 5u) << "the newest frame";
    EXPECT_EQ(shown[0].created, 3u);
    EXPECT_EQ(shown[1].last_seen, 4u);

    Isometry3d turned = at(0, 0, 2);
    turned.linear() = Eigen::AngleAxisd(std::numbers::pi / 2, Vector3d::UnitY()).toRotationMatrix();
    objects.add(frame(6, {{101, turned, 1}}));
    EXPECT_TRUE(objects.surfels()[0].position.isApprox(Vector3f(0.1f, 6, 2), 1e-5f));
    EXPECT_TRUE(objects.surfels()[0].normal.isApprox(Vector3f(-1, 0, 0), 1e-5f));
    objects.clear();
    EXPECT_TRUE(objects.all().empty());
    EXPECT_TRUE(objects.surfels().empty());
}

TEST(PixelOf, IsWhereTheSceneIsDrawn) {
    SceneView view;
    view.size = {800, 600};
    view.field_of_view_deg = 90;  // 300 pixels from the middle to the edge
    view.centre = {20, -10};
    ASSERT_TRUE(pixel_of({0, 0, 2}, view));
    EXPECT_EQ(*pixel_of({0, 0, 2}, view), glm::vec2(420, 290));
    EXPECT_NEAR(pixel_of({0, 2, 2}, view)->y, 590, 1e-3);
    EXPECT_NEAR(pixel_of({-1, 0, 2}, view)->x, 270, 1e-3);
    EXPECT_FALSE(pixel_of({0, 0, -2}, view));
}

}  // namespace
}  // namespace posefusion
