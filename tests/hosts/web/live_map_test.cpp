#include "hosts/web/live_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "tests/hosts/web/random_map.hpp"

/// A map that changes, as browsers that look on get it.
namespace posefusion::test {
namespace {

constexpr std::size_t kAll = 1'000'000;

std::map<std::size_t, std::uint64_t> versions(const LiveMap& map) {
    std::map<std::size_t, std::uint64_t> versions;
    for (const LiveMap::Cell& cell : map.cells()) versions[cell.id] = cell.version;
    return versions;
}

std::size_t surfels_in(const LiveMap& map) {
    std::size_t sum = 0;
    for (const LiveMap::Cell& cell : map.cells()) sum += cell.surfels;
    return sum;
}

std::size_t differences(const std::map<std::size_t, std::uint64_t>& a, const std::map<std::size_t, std::uint64_t>& b) {
    return static_cast<std::size_t>(std::count_if(b.begin(), b.end(), [&](const auto& cell) {
        return !a.contains(cell.first) || a.at(cell.first) != cell.second;
    }));
}

TEST(LiveMap, HoldsEverySurfelOnce) {
    const std::vector<Surfel> surfels = random_map(20'000);
    LiveMap map;
    EXPECT_TRUE(map.update(surfels, kAll));
    EXPECT_EQ(surfels_in(map), surfels.size());
    EXPECT_EQ(map.cells().size(), 6u * 6 * 6) << "cubes of a metre in a room of six";
    for (const LiveMap::Cell& cell : map.cells()) EXPECT_FALSE(cell.bytes->empty());
}

TEST(LiveMap, OnlyWhatChangesGetsAnotherVersion) {
    std::vector<Surfel> surfels = random_map(20'000);
    LiveMap map;
    map.update(surfels, kAll);
    const auto before = versions(map);
    std::reverse(surfels.begin(), surfels.end());  // as when the engine closes gaps
    map.update(surfels, kAll);
    EXPECT_EQ(versions(map), before);
    surfels[5].last_seen += 1;
    map.update(surfels, kAll);
    EXPECT_EQ(differences(before, versions(map)), 1u);
    surfels[5].position += Eigen::Vector3f(1, 0, 0);  // to the next cell
    map.update(surfels, kAll);
    EXPECT_GE(differences(before, versions(map)), 2u);
    EXPECT_EQ(surfels_in(map), surfels.size());
}

TEST(LiveMap, AnUpdateHasALimitAndTheRestComesNext) {
    const std::vector<Surfel> surfels = random_map(20'000);
    LiveMap map;
    EXPECT_FALSE(map.update(surfels, 5'000));
    const std::size_t first = surfels_in(map);
    EXPECT_GE(first, 5'000u);
    EXPECT_LT(first, 5'500u) << "a cell has about a hundred";
    int updates = 1;
    while (!map.update(surfels, 5'000)) ++updates;
    EXPECT_EQ(updates, 3);
    EXPECT_EQ(surfels_in(map), surfels.size());
}

TEST(LiveMap, WhatHasWaitedLongestComesFirst) {
    std::vector<Surfel> surfels = random_map(20'000);
    LiveMap map;
    map.update(surfels, kAll);
    const auto before = versions(map);
    for (int update = 0; update < 6; ++update) {  // everything changes all the time
        for (Surfel& s : surfels) ++s.last_seen;
        map.update(surfels, 4'000);
    }
    EXPECT_EQ(differences(before, versions(map)), before.size()) << "nothing is left behind";
}

TEST(LiveMap, CellsGoAndComeBackUnderTheirNumber) {
    const std::vector<Surfel> surfels = random_map(2'000);
    LiveMap map;
    map.update(surfels, kAll);
    const auto before = versions(map);
    EXPECT_TRUE(map.update({}, kAll));
    EXPECT_TRUE(map.cells().empty());
    map.update(surfels, kAll);
    const auto after = versions(map);
    ASSERT_EQ(after.size(), before.size());
    for (const auto& [id, version] : after) {
        ASSERT_TRUE(before.contains(id));
        EXPECT_GT(version, before.at(id));
    }
}

}  // namespace
}  // namespace posefusion::test
