#include "hosts/evaluate/alignment.hpp"

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "hosts/evaluate/evaluation.hpp"
#include "tests/hosts/evaluate/trajectories.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

using test::message_of;
using test::moved;
using test::pose;
using test::walk;

/// Somewhere else, at 0.4 of the size.
Trajectory small_copy(const Trajectory& truth) { return moved(pose({3, -2, 1}, 140), scaled(truth, 0.4)); }

double rmse(const Trajectory& truth, const Trajectory& estimate, AlignmentRule rule, bool scale) {
    return absolute_trajectory_error(truth, estimate, {{}, {rule, scale}, {}}).translation.rmse;
}

TEST(Alignment, FindsTheScaleOnlyWhereItIsWanted) {
    const Trajectory truth = walk(90), estimate = small_copy(truth);
    const PoseMatches matches = match_poses(truth, estimate);
    EXPECT_NEAR(align_trajectories(truth, estimate, matches, {AlignmentRule::Rigid, true}).scale, 2.5, 1e-9);
    EXPECT_EQ(align_trajectories(truth, estimate, matches).scale, 1);
    EXPECT_LT(rmse(truth, estimate, AlignmentRule::Rigid, true), 1e-9);
    EXPECT_LT(rmse(truth, estimate, AlignmentRule::Origin, true), 1e-9);
    EXPECT_GT(rmse(truth, estimate, AlignmentRule::Rigid, false), 0.1);
    EXPECT_GT(rmse(truth, estimate, AlignmentRule::None, true), 1);
}

TEST(Alignment, ByTheFirstPoseLeavesTheRestAsItDrifts) {
    const Trajectory truth = walk(90);
    Trajectory estimate = moved(pose({3, -2, 1}, 140), truth);
    EXPECT_LT(rmse(truth, estimate, AlignmentRule::Origin, false), 1e-12);
    estimate.front().T_world_camera.translation().z() += 0.5;  // a first pose that is off moves everything
    const AbsoluteError error = absolute_trajectory_error(truth, estimate, {{}, {AlignmentRule::Origin, false}, {}});
    EXPECT_NEAR(error.errors.front(), 0, 1e-12);
    EXPECT_NEAR(error.errors.back(), 0.5, 1e-12);
}

TEST(Alignment, NoneMeasuresInTheWorldsAsTheyAre) {
    const Trajectory truth = walk(30);
    const AbsoluteError error =
        absolute_trajectory_error(truth, moved(pose({0, 0.25, 0}), truth), {{}, {AlignmentRule::None, false}, {}});
    EXPECT_NEAR(error.translation.min, 0.25, 1e-12);
    EXPECT_NEAR(error.translation.max, 0.25, 1e-12);
    EXPECT_NEAR(error.rotation.max, 0, 1e-9);
}

TEST(Alignment, TheScaleOfACameraAtRestIsNotToBeHad) {
    Trajectory still = walk(30);
    for (StampedPose& p : still) p.T_world_camera.translation().setZero();
    for (const auto& [truth, estimate] : {std::pair{walk(30), still}, std::pair{still, walk(30)}})
        EXPECT_NE(
            message_of<Error>([&] { (void)rmse(truth, estimate, AlignmentRule::Rigid, true); }).find("does not move"),
            std::string::npos);
}

TEST(PoseMatching, OfEvoMayTakeAPoseTwice) {
    Trajectory truth = walk(30, 10), estimate = walk(90);
    EXPECT_EQ(match_poses(truth, estimate, {kMaxStampDifference, MatchingRule::Nearest}).size(), 30u);
    EXPECT_EQ(match_poses(estimate, truth, {kMaxStampDifference, MatchingRule::Nearest}).size(), 30u);
    truth = {truth[0], truth[10]};
    estimate = {truth[0], truth[0], truth[0]};
    estimate[1].stamp += std::chrono::milliseconds(20);
    estimate[2].stamp += std::chrono::milliseconds(21);
    using Matches = PoseMatches;
    EXPECT_EQ(match_poses(truth, estimate), (Matches{{0, 0}}));
    truth.resize(1);
    estimate.erase(estimate.begin());
    EXPECT_EQ(match_poses(truth, estimate), Matches{}) << "the limit itself is too far for the TUM tools";
    EXPECT_EQ(match_poses(truth, estimate, {kMaxStampDifference, MatchingRule::Nearest}), (Matches{{0, 0}}));
    truth.push_back(truth[0]);
    truth.push_back(truth[0]);
    truth[1].stamp += std::chrono::seconds(1);
    truth[2].stamp += std::chrono::seconds(2);
    estimate[0].stamp -= std::chrono::milliseconds(5);
    estimate[1].stamp -= std::chrono::milliseconds(5);
    EXPECT_EQ(match_poses(truth, estimate, {kMaxStampDifference, MatchingRule::Nearest}), (Matches{{0, 0}, {0, 1}}));
}

}  // namespace
}  // namespace posefusion
