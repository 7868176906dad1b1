#include "hosts/evaluate/ghosts.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr int kWidth = 160, kHeight = 120;
const Intrinsics kCamera{130, 130, 79.5f, 59.5f, kWidth, kHeight};

Surfel surfel(float x, float y, float z) {
    Surfel s;
    s.position = {x, y, z};
    s.normal = {0, 0, -1};
    return s;
}

/// The wall z = `depth` seen by a camera at the origin.
StaticSurface wall(float depth, const LabelImage& labels = {}) {
    StaticSurface surface;
    surface.add(DepthImage(kWidth, kHeight, depth), labels, kCamera, Eigen::Isometry3d::Identity());
    return surface;
}

GhostCount count(const StaticSurface& surface, const std::vector<Surfel>& map,
                 const Eigen::Isometry3d& T_truth_map = Eigen::Isometry3d::Identity()) {
    return count_ghosts(surface, map, T_truth_map, {StampedPose{}}, kCamera);
}

TEST(StaticSurface, AnswersWithinTheAskedDistanceOnly) {
    const StaticSurface surface = wall(2);
    EXPECT_TRUE(surface.within({0, 0, 2}, 0.015f));
    EXPECT_TRUE(surface.within({0.3, 0.2, 1.96}, 0.05f));
    EXPECT_FALSE(surface.within({0.3, 0.2, 1.94}, 0.05f));
    EXPECT_TRUE(surface.within({0.3, 0.2, 1.94}, 0.07f));
    EXPECT_FALSE(surface.within({10, 0, 2}, 0.05f));
    EXPECT_THROW((void)surface.within({0, 0, 2}, 10.0f), Error);
}

TEST(StaticSurface, WorksOnBothSidesOfTheOrigin) {
    const StaticSurface surface = wall(2);
    for (const double x : {-0.5, -0.06, -1e-4, 0.0, 1e-4, 0.06, 0.5})
        for (const double dz : {-0.045, 0.045}) EXPECT_TRUE(surface.within({x, -x, 2 + dz}, 0.05f)) << x << " " << dz;
}

TEST(StaticSurface, PeopleAndTheirEdgesAreNoPartOfIt) {
    LabelImage labels(kWidth, kHeight);
    for (int v = 0; v < kHeight; ++v)
        for (int u = 0; u < kWidth / 2; ++u) labels(u, v) = 1;
    const StaticSurface surface = wall(1, labels);
    const auto x_of = [](int u) { return (static_cast<double>(u) - 79.5) / 130; };
    EXPECT_FALSE(surface.within({x_of(20), 0, 1}, 0.05f));
    EXPECT_FALSE(surface.within({x_of(81), 0, 1}, 0.001f)) << "within the margin of two pixels";
    EXPECT_TRUE(surface.within({x_of(82), x_of(79) + x_of(81), 1}, 0.012f));
    EXPECT_THROW(StaticSurface().add(DepthImage(4, 4, 1.0f), LabelImage(8, 8), kCamera, Eigen::Isometry3d::Identity()),
                 Error);
}

TEST(StaticSurface, KeepsOnePointPerCube) {
    StaticSurface surface = wall(0.5f);  // pixels are 3.8 mm apart, cubes 10 mm wide
    const std::size_t once = surface.size();
    EXPECT_LT(once, static_cast<std::size_t>(kWidth * kHeight) / 5);
    surface.add(DepthImage(kWidth, kHeight, 0.5f), {}, kCamera, Eigen::Isometry3d::Identity());
    EXPECT_EQ(surface.size(), once);
}

TEST(Ghosts, AreSurfelsInFreeSpace) {
    const std::vector<Surfel> map{surfel(0, 0, 2), surfel(0.1f, 0, 2.03f), surfel(0, 0, 1.2f),
                                  surfel(0.1f, 0.1f, 1.1f)};
    std::vector<std::uint8_t> flags;
    const GhostCount c =
        count_ghosts(wall(2), map, Eigen::Isometry3d::Identity(), {StampedPose{}}, kCamera, {}, &flags);
    EXPECT_EQ(c.surfels, 4u);
    EXPECT_EQ(c.ghosts, 2u);
    EXPECT_EQ(c.noise, 0u);
    EXPECT_DOUBLE_EQ(c.fraction(), 0.5);
    EXPECT_EQ(flags, (std::vector<std::uint8_t>{0, 0, 1, 1}));
}

TEST(Ghosts, TheMapIsMovedIntoTheTrueWorldFirst) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation().z() = 0.5;
    EXPECT_EQ(count(wall(2), {surfel(0, 0, 1.5f)}, T).ghosts, 0u);
    EXPECT_EQ(count(wall(2), {surfel(0, 0, 1.5f)}).ghosts, 1u);
}

TEST(Ghosts, FarOffTheDepthNoiseExplainsMore) {
    // sigma(4.8 m) = 3.8 cm, sigma(2 m) = 0.6 cm
    const GhostCount far = count(wall(4.8f), {surfel(0, 0, 4.72f), surfel(0, 0, 4.6f)});
    EXPECT_EQ(far.ghosts, 2u);
    EXPECT_EQ(far.noise, 1u);
    EXPECT_EQ(count(wall(2), {surfel(0, 0, 1.92f)}).noise, 0u);
}

TEST(Ghosts, AnEmptyMapHasNone) { EXPECT_EQ(count(wall(2), {}).fraction(), 0); }

}  // namespace
}  // namespace posefusion
