#include "hosts/run/final_adjustment.hpp"

#include <gtest/gtest.h>

#include "hosts/evaluate/evaluation.hpp"
#include "hosts/run/run_session.hpp"
#include "hosts/synth/synth.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

/// Poses come nearer to the truth, and the map goes with them.
TEST(FinalAdjustment, CorrectsTrajectoryAndMap) {
    const test::TempFolder folder;
    SynthConfig made;
    made.out = folder / "recording";
    made.width = 320;
    made.height = 240;
    made.frames = 45;
    made.people = 0;
    synthesize(made);
    RunConfig config;
    config.no_people = true;
    config.sensor_timing = SensorTimingMode::Given;
    config.sensor_calibration = SensorCalibrationMode::Given;
    Console console;
    RunSession session(made.out, config);
    RunRecord record = session.run(console, [](const ScheduledFrame&) {});
    ASSERT_EQ(record.status, RunStatus::Finished) << record.error;
    const Trajectory tracked = record.trajectory();
    const Trajectory truth = session.recording().groundtruth().value();
    const auto error_of = [&](const Trajectory& trajectory) {
        return evaluate(truth, trajectory).ate.translation.rmse;
    };
    const std::vector<Surfel> before = session.slam().surfels();
    session.adjust(record, console);
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
