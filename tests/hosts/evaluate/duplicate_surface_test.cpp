#include "hosts/evaluate/duplicate_surface.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "engine/core/error.hpp"
#include "hosts/io/ply.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

constexpr int kSide = 40;          ///< surfels along the side of a patch
constexpr float kSpacing = 0.01f;  ///< metres

/// A square patch at `origin`, with a normal; surfels are jittered by the depth noise of a good map.
void add_patch(std::vector<Surfel>& map, const Eigen::Vector3f& origin, const Eigen::Vector3f& normal,
               std::uint32_t created = 0) {
    const Eigen::Vector3f u = normal.unitOrthogonal(), v = normal.cross(u);
    for (int i = 0; i < kSide; ++i)
        for (int j = 0; j < kSide; ++j) {
            Surfel& s = map.emplace_back();
            const float noise = 0.003f * std::sin(12.9898f * static_cast<float>(i) + 78.233f * static_cast<float>(j));
            s.position = origin + kSpacing * (static_cast<float>(i) * u + static_cast<float>(j) * v) + noise * normal;
            s.normal = normal;
            s.created = created;
        }
}

const Eigen::Vector3f kUp = Eigen::Vector3f(1, 2, 3).normalized(), kOrigin(-0.3f, 0.2f, 1.1f);

DuplicateSurface two_patches(float offset, const Eigen::Vector3f& second_normal = kUp, std::uint32_t created = 200) {
    std::vector<Surfel> map;
    add_patch(map, kOrigin, kUp);
    add_patch(map, kOrigin + offset * kUp, second_normal, created);
    return find_duplicate_surface(map);
}

TEST(DuplicateSurface, OneWallIsNotDouble) {
    std::vector<Surfel> map;
    add_patch(map, kOrigin, kUp);
    const DuplicateSurface d = find_duplicate_surface(map);
    EXPECT_EQ(d.surfels, map.size());
    EXPECT_EQ(d.duplicated, 0u);
    EXPECT_EQ(d.fraction(), 0);
}

TEST(DuplicateSurface, ASecondWallTwoToTenCentimetresOffIsFoundOnBothSides) {
    for (const float offset : {0.03f, 0.06f, 0.09f, -0.03f, -0.09f})
        EXPECT_DOUBLE_EQ(two_patches(offset).fraction(), 1) << offset;
    for (const float offset : {0.01f, 0.12f, -0.12f}) EXPECT_EQ(two_patches(offset).duplicated, 0u) << offset;
}

TEST(DuplicateSurface, TheBackOfABoardIsNoSecondLayer) { EXPECT_EQ(two_patches(-0.05f, -kUp).duplicated, 0u); }

TEST(DuplicateSurface, ACurvedSurfaceIsNotItsOwnSecondLayer) {
    constexpr float kRadius = 0.15f;
    std::vector<Surfel> map;
    for (int i = 0; i < 200; ++i)
        for (int j = 0; j < 20; ++j) {
            const float angle = static_cast<float>(i) * 2 * std::numbers::pi_v<float> / 200;
            Surfel& s = map.emplace_back();
            s.normal = {std::cos(angle), std::sin(angle), 0};
            s.position = kRadius * s.normal + Eigen::Vector3f(0, 0, 0.01f * static_cast<float>(j));
        }
    EXPECT_EQ(find_duplicate_surface(map).duplicated, 0u);
}

TEST(DuplicateSurface, AStraySurfelMakesNoLayer) {
    std::vector<Surfel> map;
    add_patch(map, kOrigin, kUp);
    Surfel stray = map[kSide * kSide / 2 + kSide / 2];
    stray.position += 0.05f * kUp;
    map.push_back(stray);
    std::vector<std::uint8_t> flags;
    EXPECT_EQ(find_duplicate_surface(map, {}, &flags).duplicated, 1u)
        << "it is before a wall, the wall is not before it";
    EXPECT_EQ(flags.back(), 1);
    EXPECT_EQ(flags.front(), 0);
}

TEST(DuplicateSurface, LayersOfOneVisitAreToldFromThoseOfTwo) {
    const DuplicateSurface later = two_patches(0.05f, kUp, 200), furniture = two_patches(0.05f, kUp, 20);
    EXPECT_DOUBLE_EQ(later.revisited_fraction(), 1);
    EXPECT_DOUBLE_EQ(furniture.fraction(), 1);
    EXPECT_EQ(furniture.revisited, 0u);
}

TEST(DuplicateSurface, SurvivesTheWayThroughAFile) {
    const test::TempFolder folder;
    std::vector<Surfel> map;
    add_patch(map, kOrigin, kUp, 5);
    add_patch(map, kOrigin + 0.04f * kUp, kUp, 150);
    write_ply(folder / "map.ply", map);
    const DuplicateSurface d = find_duplicate_surface(read_ply(folder / "map.ply"));
    EXPECT_EQ(d.duplicated, map.size());
    EXPECT_EQ(d.revisited, map.size());
}

TEST(DuplicateSurface, RefusesWhatMakesNoSense) {
    const auto refused = [](auto change) {
        DuplicateSurfaceConfig config;
        change(config);
        EXPECT_THROW((void)find_duplicate_surface({}, config), Error);
    };
    refused([](DuplicateSurfaceConfig& c) { c.max_offset = c.min_offset; });
    refused([](DuplicateSurfaceConfig& c) { c.min_offset = -1; });
    refused([](DuplicateSurfaceConfig& c) { c.lateral_radius = 0; });
    refused([](DuplicateSurfaceConfig& c) { c.max_angle = 90; });
    refused([](DuplicateSurfaceConfig& c) { c.support = 0; });
    EXPECT_EQ(find_duplicate_surface({}).fraction(), 0);
}

}  // namespace
}  // namespace posefusion
