#include "hosts/io/association.hpp"

#include <gtest/gtest.h>

namespace posefusion {
namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

/// Of stamps in seconds.
std::vector<Stamp> at(const std::vector<double>& seconds) {
    std::vector<Stamp> stamps;
    for (const double s : seconds) stamps.push_back(stamp_of(s));
    return stamps;
}

TEST(Association, TheClosestPairIsTakenFirst) {
    // b[0] is within reach of both; it belongs to a[1], so a[0] is left without partner.
    EXPECT_EQ(associate(at({1.000, 1.010}), at({1.012})), (Pairs{{1, 0}}));
    // Greedy, not optimal: 1.010-1.011 is taken although it leaves 1.000 with the farther 0.985.
    EXPECT_EQ(associate(at({1.000, 1.010}), at({0.985, 1.011})), (Pairs{{0, 0}, {1, 1}}));
}

TEST(Association, EachStampIsUsedOnce) {
    EXPECT_EQ(associate(at({0.00, 0.01, 0.02}), at({0.011})), (Pairs{{1, 0}}));
    EXPECT_EQ(associate(at({0.01}), at({0.005, 0.012})), (Pairs{{0, 1}}));
}

TEST(Association, TheLimitItselfIsTooFar) {
    EXPECT_TRUE(associate(at({0.0}), at({0.02})).empty());
    EXPECT_EQ(associate(at({0.0}), at({0.0199})).size(), 1u);
    EXPECT_EQ(associate(at({0.0}), at({-0.0199})).size(), 1u);
    EXPECT_EQ(associate(at({0.0}), at({0.5}), stamp_of(1.0)).size(), 1u);
}

/// Two doubles of seconds since 1970 that should be 20 ms apart are 19.99998 ms or 20.00022 ms apart.
TEST(Association, StampsSince1970AreComparedToTheNanosecond) {
    const Stamp now{1403636579763555584};
    EXPECT_TRUE(associate({now}, {now + kMaxStampDifference}).empty());
    EXPECT_EQ(associate({now}, {now + kMaxStampDifference - Stamp{1}}).size(), 1u);
    EXPECT_EQ(associate({now}, {now + Stamp{2}, now + Stamp{1}}), (Pairs{{0, 1}}));
    EXPECT_EQ(nearest_stamp({now, now + Stamp{1}, now + Stamp{2}}, now + Stamp{1}), 1u);
}

TEST(Association, OfEquallyClosePairsTheEarlierWins) {
    EXPECT_EQ(associate(at({1.0}), at({1.0625, 0.9375}), stamp_of(0.1)), (Pairs{{0, 1}}));
    EXPECT_EQ(associate(at({1.125, 1.0}), at({1.0625}), stamp_of(0.1)), (Pairs{{1, 0}}));
}

TEST(Association, OrderOfTheInputDoesNotMatter) {
    EXPECT_EQ(associate(at({3, 1, 2}), at({2.01, 3.01, 1.01})), (Pairs{{1, 2}, {2, 0}, {0, 1}}));
}

TEST(Association, NothingToPairGivesNothing) {
    EXPECT_TRUE(associate(at({}), at({1.0})).empty());
    EXPECT_TRUE(associate(at({1.0}), at({})).empty());
}

TEST(NearestStamp, FindsTheNearestWithinReach) {
    const std::vector<Stamp> stamps = at({1.0, 2.0, 3.0});
    EXPECT_EQ(nearest_stamp(stamps, stamp_of(2.01)), 1u);
    EXPECT_EQ(nearest_stamp(stamps, stamp_of(1.99)), 1u);
    EXPECT_EQ(nearest_stamp(stamps, stamp_of(0.99)), 0u);
    EXPECT_EQ(nearest_stamp(stamps, stamp_of(3.01)), 2u);
    EXPECT_EQ(nearest_stamp(stamps, stamp_of(2.6), stamp_of(1.0)), 2u);
    EXPECT_FALSE(nearest_stamp(stamps, stamp_of(2.5)));
    EXPECT_FALSE(nearest_stamp(stamps, stamp_of(3.02)));
    EXPECT_FALSE(nearest_stamp({}, stamp_of(1.0)));
}

}  // namespace
}  // namespace posefusion
