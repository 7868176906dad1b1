#include "hosts/run/final_adjustment.hpp"

#include <gtest/gtest.h>

#include "hosts/evaluate/evaluation.hpp"
#include "hosts/run/run_session.hpp"
#include "hosts/synth/synth.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

/// A short run through an empty room.
class AdjustedRun : public testing::Test {
protected:
    AdjustedRun() {
        made_.out = folder_ / "recording";
        made_.width = 320;
        made_.height = 240;
        made_.frames = 45;
        made_.people = 0;
        synthesize(made_);
        config_.no_people = true;
        config_.sensor_timing = SensorTimingMode::Given;
        config_.sensor_calibration = SensorCalibrationMode::Given;
    }

    test::TempFolder folder_;
    SynthConfig made_;
    RunConfig config_;
    Console console_;
};

/// Poses come nearer to the truth, and the map goes with them.
TEST_F(AdjustedRun, CorrectsTrajectoryAndMap) {
    RunSession session(made_.out, config_);
    RunRecord record = session.run(console_, [](const ScheduledFrame&) {});
    ASSERT_EQ(record.status, RunStatus::Finished) << record.error;
    const Trajectory tracked = record.trajectory();
    const Trajectory truth = session.recording().groundtruth().value();
    const auto error_of = [&](const Trajectory& trajectory) {
        return evaluate(truth, trajectory).ate.translation.rmse;
    };
    const std::vector<Surfel> before = session.slam().surfels();
    session.adjust(record, console_);
    ASSERT_TRUE(record.adjustment.has_value());
    ASSERT_EQ(record.adjustment->reason, "");
    EXPECT_EQ(record.adjustment->poses.size(), record.frames.size());
    EXPECT_EQ(record.adjustment->keyframes + record.adjustment->placed, record.frames.size()) << "all of them";
    EXPECT_LT(error_of(record.trajectory()), error_of(tracked));
    EXPECT_EQ(record.trajectory().front().T_world_camera.matrix(), tracked.front().T_world_camera.matrix());
    const std::vector<Surfel> after = session.slam().surfels();
    ASSERT_EQ(before.size(), after.size());
    double farthest = 0;
    for (std::size_t i = 0; i < before.size(); ++i)
        farthest = std::max(farthest, static_cast<double>((after[i].position - before[i].position).norm()));
    EXPECT_GT(farthest, 0);
    EXPECT_LT(farthest, 0.03) << "metres";
}

/// What fills the view and moves from the first frame on takes the camera along until it is seen to move.
TEST_F(AdjustedRun, FramesThatWereTrackedBeforeSomethingLargeWasSeenToMoveAreTakenBack) {
    constexpr std::size_t kRevealed = 9;  // frame
    constexpr double kStep = 0.008;       // metres from frame to frame, of what moves
    RunSession session(made_.out, config_);
    RunRecord record = session.run(console_, [](const ScheduledFrame&) {});
    ASSERT_EQ(record.status, RunStatus::Finished) << record.error;
    std::vector<Eigen::Isometry3d>& poses = record.pieces.front().poses;
    for (std::size_t i = 0; i < kRevealed; ++i) {
        const Eigen::Vector3d way(kStep * static_cast<double>(kRevealed - i), 0, 0);
        poses[i] = poses[i] * Eigen::Translation3d(way);
    }
    const auto adjusted = [&](float moving_share) {
        record.frames[kRevealed].result.moving_share = moving_share;
        return adjust_at_end(
                   made_.out, config_, record, [](std::size_t, std::size_t) {}, [] { return false; })
            .value();
    };
    const FinalAdjustment taken_in = adjusted(0.3f);
    ASSERT_EQ(taken_in.poses.size(), record.frames.size()) << taken_in.reason;
    const Trajectory truth = session.recording().groundtruth().value();
    for (std::size_t i = 0; i < kRevealed; ++i) {
        const auto since = [&](const auto& pose) -> Eigen::Vector3d {
            return (pose(kRevealed).inverse() * pose(i)).translation();
        };
        const Eigen::Vector3d off = since([&](std::size_t k) { return taken_in.poses[k]; }) -
                                    since([&](std::size_t k) { return truth[k].T_world_camera; });
        EXPECT_LT(off.norm(), 0.004) << "metres, frame " << i;
    }
    EXPECT_GT(adjusted(0).keyframes, taken_in.keyframes) << "some of these frames would have been";
}

TEST(FinalAdjustment, IsOnlyMadeWhereItIsAskedForAndCanHelp) {
    const auto asked = [](const RunConfig& config, const RunRecord& record) {
        return adjust_at_end(
            "/nowhere", config, record, [](std::size_t, std::size_t) {}, [] { return false; });
    };
    RunRecord record;
    RunConfig config;
    EXPECT_FALSE(asked(config, record).has_value()) << "without frames";
    record.pieces.emplace_back();
    EXPECT_FALSE(asked(config, record).has_value()) << "too few frames";
    for (std::size_t i = 0; i < 2 * FinalAdjustmentConfig::kFewestFrames; ++i) {
        record.frames.emplace_back();
        record.frames.back().result.tracking = TrackingState::Ok;
        record.pieces.front().frames.push_back(i);
        record.pieces.front().poses.push_back(Eigen::Isometry3d::Identity());
    }
    EXPECT_THROW((void)asked(config, record), Error) << "the recording is gone";
    config.final_adjust = false;
    EXPECT_FALSE(asked(config, record).has_value());
    config.final_adjust = true;
    config.no_loops = true;
    EXPECT_FALSE(asked(config, record).has_value()) << "tracking alone is asked for";
    config.no_loops = false;
    config.load_map = "map";
    EXPECT_FALSE(asked(config, record).has_value()) << "the map was there before";
    config.load_map.clear();
    record.status = RunStatus::Interrupted;
    EXPECT_FALSE(asked(config, record).has_value());
}

}  // namespace
}  // namespace posefusion
