#include "hosts/export/scene_points.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "tests/hosts/mesh/shapes.hpp"

namespace posefusion {
namespace {

using test::surfel_at;
using test::wall;

TEST(ScenePoints, AreSpreadEvenly) {
    std::vector<Surfel> surfels = wall(2);  // one per centimetre ...
    const std::size_t coarse = surfels.size();
    for (int i = 0; i < 20'000; ++i)  // ... and a corner of it seen from near
        surfels.push_back(
            surfel_at({0.001f * static_cast<float>(i % 200), 0.001f * static_cast<float>(i / 200), 2}, {0, 0, -1}, {}));
    const auto points = evenly_spread(surfels, 1000);
    EXPECT_LE(points.size(), 1000u);
    EXPECT_GT(points.size(), 300u);
    const auto in_corner = std::count_if(points.begin(), points.end(), [](const Surfel& s) {
        return s.position.x() >= 0 && s.position.x() < 0.2f && s.position.y() >= 0 && s.position.y() < 0.1f;
    });
    EXPECT_LT(static_cast<double>(in_corner), 0.02 * static_cast<double>(points.size()))
        << "0.5 % of the area, " << 100.0 * 20'000 / static_cast<double>(coarse + 20'000) << " % of the surfels";
}

TEST(ScenePoints, AreTheMostConfidentOfTheirPlace) {
    std::vector<Surfel> surfels;
    for (int i = 0; i < 100; ++i) {
        surfels.push_back(surfel_at({static_cast<float>(i), 0, 1}, {0, 0, -1}, {}));
        surfels.push_back(surfels.back());
        surfels.back().confidence = 90;
    }
    const auto points = evenly_spread(surfels, 100);
    ASSERT_EQ(points.size(), 100u);
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_EQ(points[i].confidence, 90);
        EXPECT_EQ(points[i].position.x(), static_cast<float>(i)) << "their order stays";
    }
}

TEST(ScenePoints, FewAreAllThere) {
    EXPECT_EQ(evenly_spread(wall(0.2f), 10'000).size(), wall(0.2f).size());
    constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
    EXPECT_TRUE(evenly_spread({surfel_at({kNone, 0, 1}, {0, 0, 1}, {})}, 5).empty()) << "not finite";
}

TEST(ScenePoints, AreSeenWhereTheDepthAgrees) {
    View view;
    view.color = ColorImage(64, 48);
    view.depth = DepthImage(64, 48);
    for (float& d : view.depth) d = 2;
    const Camera camera{{50, 50, 31.5f, 23.5f, 64, 48}};
    const std::vector<Surfel> points{
        surfel_at({0, 0, 2}, {0, 0, -1}, {}),      // seen
        surfel_at({0.2f, 0, 3}, {0, 0, -1}, {}),   // behind what was measured
        surfel_at({0.4f, 0, 1}, {0, 0, -1}, {}),   // before it: gone
        surfel_at({-0.2f, 0, 2}, {0, 0, 1}, {}),   // its back
        surfel_at({9, 0, 2}, {0, 0, -1}, {}),      // beside the image
        surfel_at({0, 0.4f, 2}, {0, 0, -1}, {}),   // seen
        surfel_at({-0.4f, 0, 2}, {0, 0, -1}, {}),  // nothing measured there
        surfel_at({0, -0.4f, 2}, {0, 0, -1}, {}),  // somebody stands there
    };
    view.depth(21, 24) = view.depth(21, 23) = view.depth(22, 23) = view.depth(22, 24) = 0;
    view.people = LabelImage(64, 48);
    for (int u = 30; u < 34; ++u)
        for (int v = 12; v < 16; ++v) view.people(u, v) = 1;
    const auto seen = points_in_view(points, view, camera);
    ASSERT_EQ(seen.size(), 2u);
    EXPECT_EQ(seen[0].point, 0u);
    EXPECT_EQ(seen[1].point, 5u);
    EXPECT_NEAR(seen[1].pixel.y(), 33.5, 1e-4);

    view.T_world_camera.translation().z() = -0.5;  // farther away than what it measures
    EXPECT_TRUE(points_in_view({points[0]}, view, camera).empty());
}

}  // namespace
}  // namespace posefusion
