#include "engine/objects/rigid_motion.hpp"

#include <gtest/gtest.h>

#include "engine/core/pinhole.hpp"
#include "engine/objects/object_view.hpp"

// The question that decides what is an object: did these points move like this?
namespace posefusion::test {
namespace {

const Intrinsics kCamera{262.5f, 262.5f, 159.5f, 119.5f, 320, 240};

/// A wall at 3 m, with a board in front of it whose parts may move apart.
struct Scene {
    double board_x = 0;  ///< metres to the right
    double lower_x = 0;  ///< ... of its lower half, besides

    [[nodiscard]] DepthImage depth() const {
        DepthImage image(kCamera.width, kCamera.height, 3.0f);
        for (int v = 0; v < image.height(); ++v)
            for (int u = 0; u < image.width(); ++u) {
                const Eigen::Vector3f p = back_project(static_cast<float>(u), static_cast<float>(v), 2, kCamera);
                const double x = static_cast<double>(p.x()) - board_x - (p.y() > 0 ? lower_x : 0.0);
                if (std::abs(x) < 0.3 && std::abs(p.y()) < 0.4f) image(u, v) = 2;
            }
        return image;
    }
    [[nodiscard]] DepthGrid grid() const { return make_depth_grid(depth(), {}, kCamera, {}); }
};

std::vector<Eigen::Vector3f> board_of(const DepthGrid& grid) {
    std::vector<Eigen::Vector3f> points;
    for (int y = 0; y < grid.camera.height; ++y)
        for (int x = 0; x < grid.camera.width; ++x)
            if (grid.depth[grid.index(x, y)] == 2) points.push_back(grid.point(x, y));
    return points;
}

Eigen::Isometry3d to_the_right(double x) { return Eigen::Isometry3d(Eigen::Translation3d(x, 0, 0)); }

TEST(RigidMotion, PointsAreWhereTheirMotionTakesThemAndNotWhereTheyWere) {
    const std::vector<Eigen::Vector3f> points = board_of(Scene{}.grid());
    ASSERT_GT(points.size(), 1000u);
    const DepthGrid now = Scene{0.2, 0}.grid();
    const Agreement moved = agreement(points, to_the_right(0.2), now);
    EXPECT_EQ(moved.fits, static_cast<int>(points.size()));
    EXPECT_EQ(moved.through, 0);
    const Agreement stood = agreement(points, Eigen::Isometry3d::Identity(), now);
    EXPECT_NEAR(stood.violated(), 0.2 / 0.6, 0.05) << "a third of it is seen through where it was";
    EXPECT_NEAR(distance_between(points, to_the_right(0.2), Eigen::Isometry3d::Identity()), 0.2, 1e-6);
}

TEST(RigidMotion, AThingWhosePartsMoveApartIsNotRigid) {
    const std::vector<Eigen::Vector3f> points = board_of(Scene{}.grid());
    const DepthGrid now = Scene{0.1, 0.25}.grid();
    for (const double x : {0.1, 0.35, 0.2})
        EXPECT_GT(agreement(points, to_the_right(x), now).violated(), 0.15f) << "whichever part is followed";
}

TEST(RigidMotion, WhatIsHiddenOrUnknownSaysNothing) {
    const std::vector<Eigen::Vector3f> points = board_of(Scene{}.grid());
    DepthImage nearer(kCamera.width, kCamera.height, 1.0f), unknown(kCamera.width, kCamera.height);
    const Agreement hidden = agreement(points, Eigen::Isometry3d::Identity(), make_depth_grid(nearer, {}, kCamera, {}));
    EXPECT_EQ(hidden.seen(), 0);
    EXPECT_EQ(hidden.hidden, static_cast<int>(points.size()));
    for (const DepthGrid& grid :
         {make_depth_grid(unknown, {}, kCamera, {}),
          make_depth_grid(Scene{}.depth(), LabelImage(kCamera.width, kCamera.height, 1), kCamera, {})}) {
        const Agreement nothing = agreement(points, Eigen::Isometry3d::Identity(), grid);
        EXPECT_EQ(nothing.seen() + nothing.hidden, 0) << "no depth, or people";
        EXPECT_EQ(nothing.violated(), 0);
    }
    const Agreement behind = agreement(points, Eigen::Isometry3d(Eigen::Translation3d(0, 0, -4)), Scene{}.grid());
    EXPECT_EQ(behind.seen() + behind.hidden, 0);
}

TEST(ObjectView, ProjectsPointsToThePixelsThatItCuts) {
    DepthImage image(kCamera.width, kCamera.height);
    for (int v = 0; v < image.height(); ++v)
        for (int u = 0; u < image.width(); ++u) image(u, v) = static_cast<float>(1000 * v + u);
    for (const PixelRange range : {PixelRange{200, 100, 260, 180}, PixelRange{0, 0, 300, 200}, PixelRange{0, 0, 5, 5},
                                   PixelRange{300, 220, 320, 240}}) {
        const ObjectView view = ObjectView::around(range, kCamera);
        const DepthImage window = view.cut(image, -1.0f);
        ASSERT_EQ(window.width(), view.camera.width);
        int seen = 0;
        for (int y = 0; y < window.height(); ++y)
            for (int x = 0; x < window.width(); ++x) {
                if (window(x, y) < 0) continue;
                const int u = static_cast<int>(window(x, y)) % 1000, v = static_cast<int>(window(x, y)) / 1000;
                seen += u >= range.left && v >= range.top && u < range.right && v < range.bottom;
                const Eigen::Vector3f p = back_project(static_cast<float>(u), static_cast<float>(v), 2, kCamera);
                const Eigen::Vector2f at = project(p, view.camera);
                ASSERT_NEAR(at.x(), x, 1e-3);
                ASSERT_NEAR(at.y(), y, 1e-3);
            }
        const int area = (range.right - range.left) * (range.bottom - range.top);
        EXPECT_EQ(seen, area / (view.stride * view.stride)) << "all of the object";
    }
}

}  // namespace
}  // namespace posefusion::test
