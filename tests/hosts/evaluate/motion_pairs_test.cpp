#include "hosts/evaluate/motion_pairs.hpp"

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "hosts/evaluate/evaluation.hpp"
#include "tests/hosts/evaluate/trajectories.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

using test::pose;
using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

/// Along z, turned about it.
Trajectory along(const std::vector<double>& positions, const std::vector<double>& degrees = {}) {
    Trajectory trajectory;
    for (std::size_t i = 0; i < positions.size(); ++i)
        trajectory.push_back({std::chrono::seconds(i), pose({0, 0, positions[i]}, degrees.empty() ? 0 : degrees[i])});
    return trajectory;
}

TEST(MotionPairs, ByFrames) {
    const Trajectory five = along({0, 0, 0, 0, 0});
    EXPECT_EQ(motion_pairs(five, DeltaUnit::Frames, 2, false), (Pairs{{0, 2}, {2, 4}}));
    EXPECT_EQ(motion_pairs(five, DeltaUnit::Frames, 2, true), (Pairs{{0, 2}, {1, 3}, {2, 4}}));
    EXPECT_EQ(motion_pairs(five, DeltaUnit::Frames, 3, false), (Pairs{{0, 3}}));
    EXPECT_TRUE(motion_pairs(five, DeltaUnit::Frames, 5, true).empty());
}

TEST(MotionPairs, ByTheWayBeginWhereTheDeltaIsReachedFirstAsInEvo) {
    EXPECT_EQ(motion_pairs(along({0, 1, 2, 3, 4, 5, 6}), DeltaUnit::Metres, 2, false), (Pairs{{2, 4}, {4, 6}}));
    EXPECT_EQ(motion_pairs(along({0, 0.5, 0, 1}), DeltaUnit::Metres, 1, false), (Pairs{{2, 3}}))
        << "the way, not the distance";
    EXPECT_TRUE(motion_pairs(along({0, 1, 1.5}), DeltaUnit::Metres, 1, false).empty());
}

TEST(MotionPairs, AllByTheWayTakeTheNearestEndWithinATenth) {
    EXPECT_EQ(motion_pairs(along({0, 0.5, 0, 1}), DeltaUnit::Metres, 1, true), (Pairs{{0, 2}, {2, 3}}));
    EXPECT_TRUE(motion_pairs(along({0, 0.5, 0, 1}), DeltaUnit::Metres, 2.5, true).empty());
    EXPECT_EQ(motion_pairs(along({0, 0.5, 0.99, 1.0}), DeltaUnit::Metres, 1, true), (Pairs{{0, 3}}));
    EXPECT_EQ(motion_pairs(along({0, 0.9, 0.99, 0.999, 0.9999}), DeltaUnit::Metres, 1, true), (Pairs{{0, 4}}));
    EXPECT_EQ(motion_pairs(along({0, 1, 1, 1}), DeltaUnit::Metres, 1, true), (Pairs{{0, 1}})) << "the first of equals";
}

TEST(MotionPairs, ByAngle) {
    const Trajectory turning = along({0, 0, 0, 0, 0}, {0, 170, 0, 60, 170});
    EXPECT_EQ(motion_pairs(turning, DeltaUnit::Degrees, 170 - 1e-6, false), (Pairs{{0, 1}, {1, 2}, {2, 4}}));
    EXPECT_EQ(motion_pairs(turning, DeltaUnit::Degrees, 170, true), (Pairs{{0, 1}, {0, 4}, {1, 2}, {2, 4}}));
}

TEST(MotionPairs, ErrorsAreThoseOfEvo) {
    // The estimate goes a tenth too far in every step, and turns by a degree too much.
    const Trajectory truth = along({0, 1, 2, 3, 4}), estimate = along({0, 1.1, 2.2, 3.3, 4.4}, {0, 1, 2, 3, 4});
    EvaluationConfig config;
    config.rpe = {1, DeltaUnit::Frames, false};
    const auto error = relative_pose_error(truth, estimate, config);
    ASSERT_TRUE(error);
    EXPECT_EQ(error->translation.count, 4u);
    EXPECT_NEAR(error->translation.min, 0.1, 1e-12);
    EXPECT_NEAR(error->translation.max, 0.1, 1e-12);
    EXPECT_NEAR(error->rotation.mean, 1, 1e-9);
    config.rpe = {2, DeltaUnit::Metres, false};
    EXPECT_NEAR(relative_pose_error(truth, estimate, config)->translation.max, 0.2, 1e-12);
    config.rpe = {50, DeltaUnit::Metres, false};
    EXPECT_FALSE(relative_pose_error(truth, estimate, config));
    for (const double delta : {0.0, -1.0, 0.5, std::nan("")}) {
        config.rpe = {delta, DeltaUnit::Frames, false};
        EXPECT_THROW((void)relative_pose_error(truth, estimate, config), Error) << delta;
    }
}

}  // namespace
}  // namespace posefusion
