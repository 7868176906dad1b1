#include "hosts/io/association.hpp"

#include <gtest/gtest.h>

namespace posefusion {
namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

TEST(Association, TheClosestPairIsTakenFirst) {
    // b[0] is within reach of both; it belongs to a[1], so a[0] is left without partner.
    EXPECT_EQ(associate({1.000, 1.010}, {1.012}), (Pairs{{1, 0}}));
    // Greedy, not optimal: 1.010-1.011 is taken although it leaves 1.000 with the farther 0.985.
    EXPECT_EQ(associate({1.000, 1.010}, {0.985, 1.011}), (Pairs{{0, 0}, {1, 1}}));
}

TEST(Association, EachStampIsUsedOnce) {
    EXPECT_EQ(associate({0.00, 0.01, 0.02}, {0.011}), (Pairs{{1, 0}}));
    EXPECT_EQ(associate({0.01}, {0.005, 0.012}), (Pairs{{0, 1}}));
}

TEST(Association, TheLimitItselfIsTooFar) {
    EXPECT_TRUE(associate({0.0}, {0.02}).empty());
    EXPECT_EQ(associate({0.0}, {0.0199}).size(), 1u);
    EXPECT_EQ(associate({0.0}, {-0.0199}).size(), 1u);
    EXPECT_EQ(associate({0.0}, {0.5}, 1.0).size(), 1u);
}

TEST(Association, OfEquallyClosePairsTheEarlierWins) {
    EXPECT_EQ(associate({1.0}, {1.0625, 0.9375}, 0.1), (Pairs{{0, 1}}));
    EXPECT_EQ(associate({1.125, 1.0}, {1.0625}, 0.1), (Pairs{{1, 0}}));
}

TEST(Association, OrderOfTheInputDoesNotMatter) {
    EXPECT_EQ(associate({3, 1, 2}, {2.01, 3.01, 1.01}), (Pairs{{1, 2}, {2, 0}, {0, 1}}));
}

TEST(Association, NothingToPairGivesNothing) {
    EXPECT_TRUE(associate({}, {1.0}).empty());
    EXPECT_TRUE(associate({1.0}, {}).empty());
}

TEST(NearestStamp, FindsTheNearestWithinReach) {
    const std::vector<double> stamps{1.0, 2.0, 3.0};
    EXPECT_EQ(nearest_stamp(stamps, 2.01), 1u);
    EXPECT_EQ(nearest_stamp(stamps, 1.99), 1u);
    EXPECT_EQ(nearest_stamp(stamps, 0.99), 0u);
    EXPECT_EQ(nearest_stamp(stamps, 3.01), 2u);
    EXPECT_EQ(nearest_stamp(stamps, 2.6, 1.0), 2u);
    EXPECT_FALSE(nearest_stamp(stamps, 2.5));
    EXPECT_FALSE(nearest_stamp(stamps, 3.02));
    EXPECT_FALSE(nearest_stamp({}, 1.0));
}

}  // namespace
}  // namespace posefusion
