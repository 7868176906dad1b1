#include "hosts/evaluate/evaluation.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "engine/core/error.hpp"
#include "tests/hosts/evaluate/trajectories.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

using test::kRadPerDeg;
using test::message_of;
using test::moved;
using test::pose;
using test::walk;

TEST(ErrorStatistics, AreThoseOfAHandComputedSample) {
    const ErrorStatistics s = error_statistics({4, 1, 3, 2});
    EXPECT_EQ(s.count, 4u);
    EXPECT_DOUBLE_EQ(s.rmse, std::sqrt(7.5));
    EXPECT_DOUBLE_EQ(s.mean, 2.5);
    EXPECT_DOUBLE_EQ(s.median, 2.5);
    EXPECT_DOUBLE_EQ(s.std, std::sqrt(1.25));
    EXPECT_DOUBLE_EQ(s.min, 1);
    EXPECT_DOUBLE_EQ(s.max, 4);
    EXPECT_DOUBLE_EQ(error_statistics({5, 1, 2}).median, 2);
    EXPECT_EQ(error_statistics({}).count, 0u);
}

TEST(AbsoluteError, ARigidMotionOfTheWholeTrajectoryCostsNothing) {
    const Trajectory truth = walk(90);
    Eigen::Isometry3d T = pose({3, -2, 1}, 140);
    T.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
    const AbsoluteError error = absolute_trajectory_error(truth, moved(T, truth));
    EXPECT_LT(error.translation.max, 1e-12);
    EXPECT_TRUE(error.T_groundtruth_estimate.isApprox(T.inverse(), 1e-9));
}

TEST(AbsoluteError, ScaleIsNotAligned) {
    Trajectory truth, estimate;
    for (int i = 0; i < 3; ++i) {
        truth.push_back({stamp_of(double(i)), pose({double(i - 1), 0, 0})});
        estimate.push_back({stamp_of(double(i)), pose({2.0 * (i - 1), 0, 0})});
    }
    const AbsoluteError error = absolute_trajectory_error(truth, estimate);
    EXPECT_NEAR(error.translation.rmse, std::sqrt(2.0 / 3.0), 1e-12);
    EXPECT_NEAR(error.translation.min, 0, 1e-12);
}

TEST(AbsoluteError, MirroredTrajectoryIsNotAlignedByAMirror) {
    const Trajectory truth = walk(300);
    Trajectory estimate = truth;
    for (StampedPose& p : estimate) p.T_world_camera.translation().x() *= -1;
    const AbsoluteError error = absolute_trajectory_error(truth, estimate);
    EXPECT_NEAR(error.T_groundtruth_estimate.linear().determinant(), 1, 1e-9);
    EXPECT_GT(error.translation.rmse, 0.05);
}

TEST(AbsoluteError, PosesFartherThan20MillisecondsTakeNoPart) {
    const Trajectory truth = walk(30);
    Trajectory estimate = truth;
    estimate[10].stamp += stamp_of(0.0199);  // still nearest to its own
    estimate[20].T_world_camera.translation().x() += 100;
    estimate[20].stamp += stamp_of(0.0165);  // as near to 21, which has its own: no partner within reach but 20
    EXPECT_EQ(absolute_trajectory_error(truth, estimate).translation.count, 30u);
    for (StampedPose& p : estimate) p.stamp += stamp_of(5);
    EXPECT_NE(message_of<Error>([&] { (void)absolute_trajectory_error(truth, estimate); }).find("same recording"),
              std::string::npos);
}

TEST(AbsoluteError, OnePairIsNotEnough) {
    const Trajectory truth = walk(30);
    EXPECT_THROW((void)absolute_trajectory_error(truth, {truth[3]}), Error);
    EXPECT_NO_THROW((void)absolute_trajectory_error(truth, {truth[3], truth[4]}));
}

TEST(RelativeError, ConstantDriftIsReportedPerSecond) {
    const Trajectory truth = walk(150);
    Trajectory estimate;
    for (const StampedPose& p : truth) {
        const double t = to_seconds(p.stamp - truth.front().stamp);
        Eigen::Isometry3d T = p.T_world_camera;
        T.linear() = T.linear() * Eigen::AngleAxisd(2 * kRadPerDeg * t, Eigen::Vector3d::UnitZ()).toRotationMatrix();
        estimate.push_back({p.stamp, T});
    }
    const auto error = relative_pose_error(truth, estimate);
    ASSERT_TRUE(error);
    EXPECT_NEAR(error->rotation.min, 2, 1e-6);
    EXPECT_NEAR(error->rotation.max, 2, 1e-6);
}

TEST(RelativeError, DriftOfThePositionIsReportedPerSecond) {
    Trajectory truth, estimate;
    for (int i = 0; i < 120; ++i) {
        truth.push_back({stamp_of(i / 30.0), pose({0, 0, 0})});
        estimate.push_back({stamp_of(i / 30.0), pose({0.03 * i / 30.0, 0, 0})});
    }
    const auto error = relative_pose_error(truth, estimate);
    ASSERT_TRUE(error);
    EXPECT_NEAR(error->translation.mean, 0.03, 1e-9);
    EXPECT_NEAR(error->rotation.max, 0, 1e-9);
    // Pairs that end on the very last pose are left out: 120 - 30 starts reach a partner, the last of them the last
    // pose.
    EXPECT_EQ(error->translation.count, 89u);
}

TEST(RelativeError, WhereTheWorldsOfBothTrajectoriesLieDoesNotMatter) {
    const Trajectory truth = walk(90);
    const auto error = relative_pose_error(truth, moved(pose({5, 6, 7}, 77), truth));
    ASSERT_TRUE(error);
    EXPECT_LT(error->translation.max, 1e-9);
    EXPECT_LT(error->rotation.max, 1e-6);
}

TEST(RelativeError, IsAbsentForLessThanASecond) {
    const Trajectory truth = walk(20);
    EXPECT_FALSE(relative_pose_error(truth, truth));
    EXPECT_THROW((void)relative_pose_error({}, truth), Error);
    const Evaluation evaluation = evaluate(truth, truth);
    EXPECT_FALSE(evaluation.rpe);
    EXPECT_NE(evaluation_table(evaluation).find("too short"), std::string::npos);
    EXPECT_NE(evaluation_json(evaluation).find("\"rpe\": null"), std::string::npos);
}

TEST(AlignPoses, FindsTheMotionBetweenTheWorldsEvenAlongALine) {
    Trajectory truth, estimate;
    Eigen::Isometry3d T = pose({3, -2, 1}, 140);
    T.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
    for (int i = 0; i < 30; ++i) {
        const double noise = 0.001 * (i % 2 == 0 ? 1 : -1);
        truth.push_back({stamp_of(i / 30.0), T * pose({0.01 * i, 0, 0})});
        estimate.push_back({stamp_of(i / 30.0), pose({0.01 * i, noise, -noise})});
    }
    const Eigen::Isometry3d found = align_poses(truth, estimate);
    EXPECT_LT(Eigen::AngleAxisd(found.linear().transpose() * T.linear()).angle(), 1e-9);
    EXPECT_LT((found.translation() - T.translation()).norm(), 1e-9);
    for (StampedPose& p : estimate) p.stamp += stamp_of(9);
    EXPECT_THROW((void)align_poses(truth, estimate), Error);
}

TEST(Evaluation, MeasuresPathAndDistanceFromStart) {
    Trajectory trajectory;
    for (int i = 0; i < 5; ++i)
        trajectory.push_back({stamp_of(double(i)), pose({i < 3 ? double(i) : double(4 - i), 0, 0})});
    const Evaluation evaluation = evaluate(trajectory, trajectory);
    EXPECT_DOUBLE_EQ(evaluation.path_length, 4);
    EXPECT_DOUBLE_EQ(evaluation.max_distance_from_start, 2);
    EXPECT_DOUBLE_EQ(*evaluation.duration, 4);
}

/// Values of the benchmark's own Python tools for these files.
class BenchmarkFiles : public testing::TestWithParam<const char*> {};

TEST_P(BenchmarkFiles, GiveTheNumbersOfTheBenchmarksTools) {
    const auto folder = test::shared_data() / "evaluator";
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "needs the shared recordings at " << folder;
    const Evaluation e =
        evaluate(read_trajectory(folder / "freiburg1_xyz-groundtruth.txt"), read_trajectory(folder / GetParam()));
    EXPECT_EQ(e.ate.translation.count, 786u);
    EXPECT_NEAR(e.ate.translation.rmse, 0.013473, 5e-7);
    EXPECT_NEAR(e.ate.translation.mean, 0.012029, 5e-7);
    EXPECT_NEAR(e.ate.translation.median, 0.011176, 5e-7);
    EXPECT_NEAR(e.ate.translation.std, 0.006068, 5e-7);
    EXPECT_NEAR(e.ate.translation.min, 0.000939, 5e-7);
    EXPECT_NEAR(e.ate.translation.max, 0.034727, 2e-6);
    ASSERT_TRUE(e.rpe);
    EXPECT_EQ(e.rpe->translation.count, 753u);
    EXPECT_NEAR(e.rpe->translation.rmse, 0.021217, 5e-7);
    EXPECT_NEAR(e.rpe->translation.median, 0.019309, 2e-6);
    EXPECT_NEAR(e.rpe->rotation.rmse, 0.934482, 5e-6);
    EXPECT_NEAR(e.rpe->rotation.max, 2.296, 1e-4);
}
INSTANTIATE_TEST_SUITE_P(Freiburg1Xyz, BenchmarkFiles,
                         testing::Values("freiburg1_xyz-rgbdslam.txt", "freiburg1_xyz-rgbdslam_drift.txt"));

}  // namespace
}  // namespace posefusion
