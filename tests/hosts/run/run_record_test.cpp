#include "hosts/run/run_record.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace posefusion {
namespace {

TEST(RunRecord, SummaryOfTimes) {
    std::vector<double> times;
    for (int i = 100; i >= 1; --i) times.push_back(i);
    times.push_back(std::nan(""));
    const TimeSummary summary = summarize(times);
    EXPECT_EQ(summary.count, 100u);
    EXPECT_DOUBLE_EQ(summary.median, 50.5);
    EXPECT_DOUBLE_EQ(summary.mean, 50.5);
    EXPECT_DOUBLE_EQ(summary.p95, 95);
    EXPECT_DOUBLE_EQ(summarize({7}).p95, 7);
    EXPECT_EQ(summarize({}).count, 0u);
    EXPECT_TRUE(std::isnan(summarize({}).median));
}

TEST(RunRecord, GpuStagesKeepTheOrderOfExecutionAlsoOfLateStages) {
    RunRecord record;
    record.frames.resize(2);
    record.frames[0].result.gpu_times = {{"preprocess", 1}, {"fuse", 2}};
    record.frames[1].result.gpu_times = {{"preprocess", 3}, {"track", 4}, {"track", 1}, {"fuse", 5}};
    const std::vector<StageSeries> stages = record.gpu_stages();
    ASSERT_EQ(stages.size(), 3u);
    EXPECT_EQ(stages[0].name, "preprocess");
    EXPECT_EQ(stages[1].name, "track");
    EXPECT_EQ(stages[2].name, "fuse");
    EXPECT_TRUE(std::isnan(stages[1].milliseconds[0])) << "did not run on the first frame";
    EXPECT_EQ(stages[1].milliseconds[1], 5) << "parts of a stage add up";
    EXPECT_EQ(stages[2].milliseconds, (std::vector<double>{2, 5}));
}

TEST(RunRecord, FramesThatWaitedForTheCompilerAreLeftOutOfTimes) {
    RunRecord record;
    for (const double slam_ms : {9000.0, 5000.0, 20.0, 21.0, 22.0, 500.0, 20.0, 21.0, 22.0, 20.0}) {
        record.frames.emplace_back();
        record.frames.back().slam_ms = slam_ms;
        record.frames.back().interval_ms = slam_ms + 1;
        record.frames.back().result.gpu_times = {{"fuse", slam_ms / 2}};
    }
    EXPECT_EQ(record.compiling_frames(), 2u);
    const TimeSummary interval = summarize(record.intervals()), slam = summarize(record.host_stages()[4].milliseconds),
                      fuse = summarize(record.gpu_stages()[0].milliseconds);
    EXPECT_EQ(interval.count, 8u);
    EXPECT_DOUBLE_EQ(interval.mean, 81.75) << "a slow frame later counts";
    EXPECT_DOUBLE_EQ(slam.mean, 80.75);
    EXPECT_DOUBLE_EQ(fuse.mean, 40.375);
    EXPECT_EQ(record.intervals().size(), 10u) << "one per frame";

    record.frames[0].slam_ms = 30;
    EXPECT_EQ(record.compiling_frames(), 0u) << "nothing was compiled at the beginning";
    record.frames.resize(3);
    record.frames[0].slam_ms = 9000;
    EXPECT_EQ(record.compiling_frames(), 0u) << "too few to tell";
}

TEST(RunRecord, TakesPicturesOnlyOfSamples) {
    RunRecord record;
    for (const bool sample : {false, true}) {
        ScheduledFrame frame;
        frame.input.index = 7;
        frame.input.color = ColorImage(4, 4);
        frame.people.segmentation.people = 2;
        record.add(frame, 10, sample);
    }
    EXPECT_EQ(record.frames.size(), 2u);
    EXPECT_EQ(record.frames[1].people, 2);
    ASSERT_EQ(record.samples.size(), 1u);
    EXPECT_EQ(record.samples[0].color.width(), 4);
    EXPECT_EQ(record.intervals(), (std::vector<double>{10, 10}));
}

TEST(RunRecord, LostIntervals) {
    using enum TrackingState;
    RunRecord record;
    for (const TrackingState state : {FirstFrame, Ok, Failed, Lost, Relocalised, Failed, Ok, Lost, Failed}) {
        record.frames.emplace_back();
        record.frames.back().result.tracking = state;
    }
    const std::vector<LostInterval> lost = record.lost_intervals();
    ASSERT_EQ(lost.size(), 3u);
    EXPECT_EQ(lost[0].first, 2u);
    EXPECT_EQ(lost[0].last, 3u);
    EXPECT_TRUE(lost[0].found_again);
    EXPECT_EQ(lost[1].frames(), 1u);
    EXPECT_EQ(lost[2].frames(), 2u);
    EXPECT_FALSE(lost[2].found_again) << "the end of the run";
    EXPECT_TRUE(RunRecord{}.lost_intervals().empty());
}

/// All frames in one piece.
RunRecord record_of(const std::vector<TrackingState>& states) {
    RunRecord record;
    record.pieces.resize(1);
    for (const TrackingState state : states) {
        FrameRecord frame;
        frame.stamp = std::chrono::seconds(record.frames.size());
        frame.result.tracking = state;
        record.pieces[0].frames.push_back(record.frames.size());
        record.pieces[0].poses.push_back(Eigen::Isometry3d::Identity());
        record.frames.push_back(frame);
    }
    record.surfels = record.stable_surfels = 1000;
    return record;
}

TEST(RunRecord, TheTrajectoryHasThePosesThatAreKnown) {
    using enum TrackingState;
    RunRecord record = record_of({FirstFrame, Ok, Failed, Lost, Relocalised, Ok});
    record.pieces[0].poses[4].translation().x() = 7;
    const Trajectory trajectory = record.trajectory();
    ASSERT_EQ(trajectory.size(), 4u) << "a pose that is only held is none";
    EXPECT_EQ(trajectory[2].stamp, std::chrono::seconds(4));
    EXPECT_EQ(trajectory[2].T_world_camera.translation().x(), 7);
    EXPECT_EQ(record.tracked(record.pieces[0]), 4u);
    EXPECT_TRUE(RunRecord{}.trajectory().empty());
}

TEST(RunRecord, PiecesOfMapAreKeptApart) {
    using enum TrackingState;
    RunRecord record = record_of({FirstFrame, Ok, Lost, FirstFrame, Lost, Ok, Ok});
    record.pieces = {{{3, 4, 5, 6}, std::vector<Eigen::Isometry3d>(4, Eigen::Isometry3d::Identity())},
                     {{0, 1, 2}, std::vector<Eigen::Isometry3d>(3, Eigen::Isometry3d::Identity())}};
    const Trajectory map = record.trajectory(), other = record.trajectory(record.pieces[1]);
    ASSERT_EQ(map.size(), 3u);
    EXPECT_EQ(map[0].stamp, std::chrono::seconds(3));
    ASSERT_EQ(other.size(), 2u);
    EXPECT_EQ(other[1].stamp, std::chrono::seconds(1));
    const std::vector<LostInterval> all = record.lost_intervals(), in_map = record.lost_intervals({3, 4, 5, 6});
    ASSERT_EQ(all.size(), 2u);
    EXPECT_FALSE(all[0].found_again) << "a new piece began";
    ASSERT_EQ(in_map.size(), 1u);
    EXPECT_EQ(in_map[0].first, 1u) << "counted in the piece";
    EXPECT_TRUE(in_map[0].found_again);
}

TEST(RunRecord, ARunThatIsOfNoUseSaysWhy) {
    using enum TrackingState;
    EXPECT_EQ(RunRecord().fault(), "");
    EXPECT_EQ(record_of({FirstFrame, Ok, Lost, Ok}).fault(), "");
    std::vector<TrackingState> lost(12, Lost);
    lost[0] = FirstFrame;
    EXPECT_NE(record_of(lost).fault().find("lost in 11 of 12 frames"), std::string::npos);
    EXPECT_EQ(record_of({FirstFrame, Lost, Lost}).fault(), "") << "too few to say";
    RunRecord empty = record_of({FirstFrame, Ok});
    empty.surfels = 0;
    EXPECT_NE(empty.fault().find("the map is empty"), std::string::npos);
    RunRecord never_stable = record_of(std::vector<TrackingState>(60, Ok));
    never_stable.stable_surfels = 0;
    EXPECT_NE(never_stable.fault().find("stable"), std::string::npos);
    never_stable = record_of(std::vector<TrackingState>(20, Ok));
    never_stable.stable_surfels = 0;
    EXPECT_EQ(never_stable.fault(), "") << "too short to say";
    RunRecord scattered = record_of(std::vector<TrackingState>(12, Ok));
    scattered.pieces = {{{0, 1, 2, 3}, std::vector<Eigen::Isometry3d>(4)},
                        {{4, 5, 6}, std::vector<Eigen::Isometry3d>(3)}};
    EXPECT_NE(scattered.fault().find("2 pieces that never met, and the main one has only 4 of 12 frames"),
              std::string::npos);
}

TEST(RunRecord, ALeapOfTheCameraWhileTheMapIsYoungIsInDoubt) {
    using enum TrackingState;
    std::vector<TrackingState> states(40, Ok);
    states[0] = FirstFrame;
    const auto moving = [&](double usual, std::size_t frame, double leap) {
        RunRecord record = record_of(states);
        double way = 0;
        for (std::size_t i = 0; i < states.size(); ++i) {
            record.frames[i].index = i;
            record.frames[i].stamp = std::chrono::milliseconds(33 * i);
            if (i > 0) way += i == frame ? leap : usual;
            record.pieces[0].poses[i] = Eigen::Translation3d(way, 0, 0);
        }
        return record;
    };
    EXPECT_NE(moving(0.01, 5, 0.15).leap_at_the_beginning().find("leapt by 15 cm in frame 5"), std::string::npos);
    EXPECT_EQ(moving(0.01, 5, 0.04).leap_at_the_beginning(), "") << "a jerk";
    EXPECT_EQ(moving(0.08, 5, 0.15).leap_at_the_beginning(), "") << "a fast camera";
    RunRecord gap = moving(0.01, 5, 0.15);
    for (std::size_t i = 5; i < states.size(); ++i) gap.frames[i].stamp += std::chrono::seconds(1);
    EXPECT_EQ(gap.leap_at_the_beginning(), "") << "frames are missing";
    RunRecord found_again = moving(0.01, 5, 0.15);
    found_again.frames[5].result.tracking = Relocalised;
    EXPECT_EQ(found_again.leap_at_the_beginning(), "");
    RunRecord judged = moving(0.01, 5, 0.15);
    EXPECT_EQ(judged.judge(), std::vector{judged.leap_at_the_beginning()});
    EXPECT_EQ(judged.warnings, std::vector{judged.leap_at_the_beginning()});
}

TEST(RunRecord, ARunThatIsOfNoUseHasFailed) {
    using enum TrackingState;
    RunRecord good = record_of({FirstFrame, Ok});
    good.judge();
    EXPECT_EQ(good.status, RunStatus::Finished);
    EXPECT_TRUE(good.warnings.empty());
    RunRecord too_short = record_of({FirstFrame, Ok});
    too_short.stable_surfels = 0;
    too_short.judge();
    EXPECT_EQ(too_short.status, RunStatus::Finished);
    ASSERT_EQ(too_short.warnings.size(), 1u);
    EXPECT_NE(too_short.warnings[0].find("map.ply is empty"), std::string::npos);
    RunRecord short_and_lost = record_of({FirstFrame, Lost, Lost, Lost});
    short_and_lost.judge();
    EXPECT_EQ(short_and_lost.status, RunStatus::Finished);
    ASSERT_EQ(short_and_lost.warnings.size(), 1u);
    EXPECT_NE(short_and_lost.warnings[0].find("lost in 3 of 4 frames"), std::string::npos);
    RunRecord empty = record_of({FirstFrame, Ok});
    empty.surfels = 0;
    empty.judge();
    EXPECT_EQ(empty.status, RunStatus::Failed);
    EXPECT_EQ(empty.error, empty.fault());
    EXPECT_EQ(empty.warnings, std::vector{empty.fault()});
    RunRecord interrupted = record_of({FirstFrame, Ok});
    interrupted.surfels = 0;
    interrupted.status = RunStatus::Interrupted;
    interrupted.judge();
    EXPECT_EQ(interrupted.status, RunStatus::Interrupted) << "it was not given the time for a result";
}

}  // namespace
}  // namespace posefusion
