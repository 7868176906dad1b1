#include "tools/evaluate_objects/object_scores.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/error.hpp"
#include "tools/evaluate_objects/triangle_distance.hpp"

namespace posefusion {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

Stamp at_frame(int i) { return std::chrono::duration_cast<Stamp>(std::chrono::duration<double>(1000 + i / 30.0)); }

Eigen::Isometry3d pose(const Vector3d& position, double angle, const Vector3d& axis) {
    Eigen::Isometry3d T(Eigen::AngleAxisd(angle, axis.normalized()));
    T.pretranslate(position);
    return T;
}

/// A square of 0.4 m in the plane z = 0.1 that moves and turns after it has stood for 10 frames.
TrueObject square() {
    TrueObject object{"box", 101, true, {}, {}};
    object.mesh.vertices = {{-0.2f, -0.2f, 0.1f}, {0.2f, -0.2f, 0.1f}, {0.2f, 0.2f, 0.1f}, {-0.2f, 0.2f, 0.1f}};
    object.mesh.faces = {{0, 1, 2}, {0, 2, 3}};
    for (int i = 0; i < 40; ++i) {
        const double moved = std::max(i - 10, 0) / 30.0;
        object.poses.push_back({at_frame(i), pose({0.5 * moved, 1, 2}, moved, {1, 2, 3})});
    }
    return object;
}

const Eigen::Isometry3d kTruthRun = pose({3, -1, 0.5}, 1.1, {0, 1, 2});
const Eigen::Isometry3d kTrueEstimated = pose({0.3, 0.2, -0.4}, 0.7, {2, 0, 1});  // of the object's frame

/// As a run that makes no error has it: in another world, from the middle of the motion on, in a frame of its own.
EstimatedObject exact_estimate(const TrueObject& truth) {
    EstimatedObject estimate{101, {}, {}};
    for (std::size_t i = 15; i < truth.poses.size(); ++i)
        estimate.poses.push_back(
            {truth.poses[i].stamp, kTruthRun.inverse() * truth.poses[i].T_world_camera * kTrueEstimated});
    for (const Vector3d& p : {Vector3d(0, 0, 0.1), Vector3d(0.1, -0.15, 0.1), Vector3d(-0.2, 0.2, 0.1)}) {
        Surfel surfel{};
        surfel.position = (kTrueEstimated.inverse() * p).cast<float>();
        estimate.model.push_back(surfel);
    }
    return estimate;
}

TEST(ObjectScores, AnExactEstimateHasNoErrorWhateverItsWorldAndFrame) {
    const TrueObject truth = square();
    const ObjectScores scores = score_object(truth, exact_estimate(truth), kTruthRun);
    EXPECT_EQ(scores.poses, 25u);
    EXPECT_NEAR(scores.ate, 0, 1e-9);
    EXPECT_NEAR(scores.rotation, 0, 1e-4);
    EXPECT_NEAR(scores.surface_mean, 0, 1e-6);
    EXPECT_EQ(scores.surface_beyond_cm, 0);
}

TEST(ObjectScores, ErrorsOfPositionAndSurfaceAreMeasured) {
    const TrueObject truth = square();
    EstimatedObject estimate = exact_estimate(truth);
    // Half of the poses to one side by 2 cm, half to the other: no constant offset explains it.
    for (std::size_t i = 0; i < 24; ++i) {
        const Vector3d aside(i % 2 == 0 ? 0.02 : -0.02, 0, 0);
        estimate.poses[i].T_world_camera.pretranslate(kTruthRun.linear().transpose() * aside);
    }
    estimate.poses.pop_back();
    estimate.model.front().position =
        (kTrueEstimated.inverse() * Vector3d(0.1, 0.1, 0.13)).cast<float>();  // 3 cm off the surface
    const ObjectScores scores = score_object(truth, estimate, kTruthRun);
    EXPECT_NEAR(scores.ate, 0.02, 0.001);
    EXPECT_NEAR(scores.surface_mean, 0.01, 0.001);
    EXPECT_NEAR(scores.surface_beyond_cm, 1.0 / 3, 1e-9);
}

TEST(ObjectScores, WithoutACommonTimeThereIsNothingToCompare) {
    const TrueObject truth = square();
    EstimatedObject estimate = exact_estimate(truth);
    for (StampedPose& p : estimate.poses) p.stamp += std::chrono::hours(1);
    EXPECT_THROW((void)score_object(truth, estimate, kTruthRun), Error);
}

TEST(ObjectScores, EachObjectIsMatchedOnceTheLargestOverlapFirst) {
    const std::vector<TrueObject> truth{{"cart", 101, true, {}, {}}, {"ball", 102, true, {}, {}}};
    const std::vector<EstimatedObject> estimates{{101, {}, {}}, {103, {}, {}}};
    MaskScores scores;
    scores.shared = {{{101, 101}, 50}, {{102, 101}, 80}, {{101, 103}, 20}};
    const auto matches = match_objects(truth, estimates, scores);
    EXPECT_EQ(matches[0], 1u);
    EXPECT_EQ(matches[1], 0u);
}

TEST(ObjectTruth, AnObjectStandsBeginsAndMoves) {
    const std::vector<ObjectState> states = states_of(square());
    EXPECT_EQ(states[9], ObjectState::Stands);
    EXPECT_EQ(states[14], ObjectState::Begins);
    EXPECT_EQ(states[35], ObjectState::Moves);
}

TEST(ObjectTruth, WhatMovesFromTheFirstFrameOnBeginsThere) {
    TrueObject truth = square();
    truth.poses.erase(truth.poses.begin(), truth.poses.begin() + 20);
    const std::vector<ObjectState> states = states_of(truth);
    EXPECT_EQ(states[2], ObjectState::Begins);
    EXPECT_EQ(states[12], ObjectState::Moves);
}

TEST(TriangleDistance, IsThatToTheNearestPointOfFaceEdgeOrCorner) {
    const Vector3f a(0, 0, 0), b(1, 0, 0), c(0, 1, 0);
    EXPECT_LT((closest_on_triangle({0.2f, 0.3f, 5}, a, b, c) - Vector3f(0.2f, 0.3f, 0)).norm(), 1e-6f);
    EXPECT_LT((closest_on_triangle({0.5f, -2, 1}, a, b, c) - Vector3f(0.5f, 0, 0)).norm(), 1e-6f);
    EXPECT_LT((closest_on_triangle({1, 1, 0}, a, b, c) - Vector3f(0.5f, 0.5f, 0)).norm(), 1e-6f);
    EXPECT_LT((closest_on_triangle({-1, 2, 3}, a, b, c) - c).norm(), 1e-6f);
    const TriangleDistance distance({{a, b, c}, {{0, 1, 2}}});
    EXPECT_FLOAT_EQ(distance({0.2f, 0.3f, -0.25f}), 0.25f);
}

}  // namespace
}  // namespace posefusion
