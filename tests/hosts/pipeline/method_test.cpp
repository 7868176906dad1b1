// The whole method on small frames: what a run does with cameras, pauses and frames of no use.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <functional>
#include <thread>
#include <utility>
#include <vector>

#include "engine/core/error.hpp"
#include "hosts/pipeline/frame_scheduler.hpp"
#include "hosts/pipeline/posefusion.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

using test::message_of;

constexpr int kWidth = 32, kHeight = 24;
constexpr double kPeriod = 1.0 / 30;  ///< seconds between frames

Camera small_camera() { return {{30, 30, 15.5f, 11.5f, kWidth, kHeight}, 1000, {}}; }

/// A slanted wall with a pattern; a black one has no light on it.
RawFrame make_frame(std::size_t i, bool black = false) {
    RawFrame frame;
    frame.stamp = stamp_of(1 + kPeriod * static_cast<double>(i));
    frame.stamp_text = seconds_text(frame.stamp);
    frame.color_name = frame.depth_name = "frame " + std::to_string(i);
    frame.color = ColorImage(kWidth, kHeight);
    frame.depth = RawDepth(kWidth, kHeight);
    for (int v = 0; v < kHeight; ++v) {
        for (int u = 0; u < kWidth; ++u) {
            const auto grey = static_cast<std::uint8_t>(black ? 0 : 40 + (u * 37 + v * 53) % 160);
            frame.color(u, v) = {grey, grey, grey};
            frame.depth(u, v) = static_cast<std::uint16_t>(1500 + 10 * u + 5 * v);
        }
    }
    return frame;
}

/// Frames without end of a camera, or a recording of so many.
class FakeSource : public FrameSource {
public:
    /// @param wait  of a camera: until the next frame comes
    explicit FakeSource(
        std::size_t frames, bool live = false, std::size_t black = kEndless, std::function<void()> wait = [] {})
        : frames_(frames), black_(black), wait_(std::move(wait)) {
        facts_.location = facts_.name = "fake";
        facts_.camera = small_camera();
        facts_.live = live;
        for (std::size_t i = 0; i < frames && !live; ++i) facts_.frames.push_back({make_frame(i).stamp, ""});
    }
    RawFrame read(std::size_t i) const override {
        if (facts_.live && i >= frames_) throw SourceLost("fake: unplugged");
        wait_();
        return make_frame(i, i == black_);
    }

private:
    std::size_t frames_, black_;
    std::function<void()> wait_;
};

/// Stands still but for what the test lets pass.
class FakeClock final : public PlayClock {
public:
    [[nodiscard]] double seconds() const override { return now_; }
    void wait_until(double, const std::function<bool()>&) override {}
    void pass(double seconds) { now_ = now_ + seconds; }

private:
    std::atomic<double> now_ = 100;
};

RunConfig without_people() {
    RunConfig config;
    config.no_people = true;
    return config;
}

class Method : public testing::Test {
protected:
    /// Runs over that source. @return what became of its frames
    std::vector<ScheduledFrame> run(std::unique_ptr<FrameSource> source, Schedule schedule, Pace pace,
                                    PlayClock* clock = nullptr) {
        Recording recording(std::move(source));
        PoseFusion method(recording, without_people());
        FrameScheduler scheduler(recording, method);
        std::vector<ScheduledFrame> frames;
        observer_.frame_done = [&](ScheduledFrame& frame) { frames.push_back(std::move(frame)); };
        observer_.warning = [this](const std::string&) { ++warnings_; };
        outcome_ = scheduler.run(0, schedule, observer_, pace, clock);
        dropped_ = scheduler.dropped();
        return frames;
    }
    FrameScheduler::Observer observer_;
    PipelineOutcome outcome_;
    std::size_t dropped_ = 0;
    std::atomic<int> warnings_ = 0;
};

TEST_F(Method, ACameraThatIsTooFastLosesWholeFramesAndTheyAreCounted) {
    constexpr std::size_t kFrames = 300;
    observer_.frame_due = [] { std::this_thread::sleep_for(std::chrono::milliseconds(20)); };
    const auto wait = [] { std::this_thread::sleep_for(std::chrono::milliseconds(1)); };
    const auto frames = run(std::make_unique<FakeSource>(kFrames, true, FrameSource::kEndless, wait),
                            Schedule::Pipelined, Pace::RealTime);
    EXPECT_TRUE(outcome_.error) << "it was unplugged";
    EXPECT_GT(dropped_, 0u);
    EXPECT_EQ(frames.size() + dropped_, kFrames) << "every frame is one or the other";
    ASSERT_GT(frames.size(), 1u);
    EXPECT_EQ(frames.back().number + 1, frames.size());
    for (std::size_t i = 1; i < frames.size(); ++i) {
        EXPECT_EQ(frames[i].input.index, frames[i - 1].input.index + 1 + frames[i].dropped - frames[i - 1].dropped);
        EXPECT_EQ(frames[i].previous_stamp, frames[i - 1].input.stamp) << "of the frames that were not dropped";
    }
}

TEST_F(Method, WithoutRealTimeNothingIsDropped) {
    const auto frames = run(std::make_unique<FakeSource>(12), Schedule::Pipelined, Pace::EveryFrame);
    EXPECT_FALSE(outcome_.error);
    EXPECT_EQ(frames.size(), 12u);
    EXPECT_EQ(dropped_, 0u);
}

TEST_F(Method, TimeForWhichTheClockStandsIsNoLatency) {
    constexpr double kDue = 0.25;
    FakeClock clock;
    observer_.frame_due = [&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(5));  // as if paused
        clock.pass(kDue);
    };
    const auto frames = run(std::make_unique<FakeSource>(4), Schedule::Sequential, Pace::EveryFrame, &clock);
    ASSERT_EQ(frames.size(), 4u);
    for (const ScheduledFrame& frame : frames) {
        EXPECT_GT(frame.slam_ms, 0) << "tracking takes time, even if the clock is stopped meanwhile";
        EXPECT_DOUBLE_EQ(frame.latency_ms, 1000 * kDue + frame.slam_ms);
    }
}

TEST_F(Method, TheTimeUntilACameraHasAFrameIsNoLatency) {
    FakeClock clock;
    const auto wait = [&] { clock.pass(kPeriod); };
    const auto frames = run(std::make_unique<FakeSource>(3, true, FrameSource::kEndless, wait), Schedule::Sequential,
                            Pace::RealTime, &clock);
    ASSERT_EQ(frames.size(), 3u);
    for (const ScheduledFrame& frame : frames) EXPECT_EQ(frame.latency_ms, frame.slam_ms);
}

TEST_F(Method, FramesOfOnesOwnAreTrackedAsARunDoesIt) {
    constexpr std::size_t kFrames = 6, kBlack = 3;
    const auto frames =
        run(std::make_unique<FakeSource>(kFrames, false, kBlack), Schedule::Sequential, Pace::EveryFrame);
    ASSERT_EQ(frames.size(), kFrames - 1);
    EXPECT_EQ(warnings_, 1);

    PoseFusion slam(small_camera(), without_people());
    std::size_t at = 0;
    for (std::size_t i = 0; i < kFrames; ++i) {
        RawFrame raw = make_frame(i, i == kBlack);
        DepthImage depth = to_metres(raw.depth, small_camera().depth_scale);
        if (i == kBlack) {
            EXPECT_NE(message_of<Error>([&] { slam.process(raw.color, depth, raw.stamp); }).find("is black"),
                      std::string::npos);
            EXPECT_NE(message_of<Error>([&] {
                          slam.process(make_frame(0).color, DepthImage(kWidth, kHeight), raw.stamp);
                      }).find("no measurement"),
                      std::string::npos);
            continue;
        }
        const ProcessedFrame frame = slam.process(std::move(raw.color), std::move(depth), raw.stamp);
        EXPECT_EQ(frame.number, frames[at].number);
        EXPECT_EQ(frame.result.T_world_camera.matrix(), frames[at].result.T_world_camera.matrix()) << i;
        EXPECT_EQ(frame.result.surfels, frames[at].result.surfels) << i;
        ++at;
    }
    const Trajectory trajectory = slam.trajectory();
    ASSERT_EQ(trajectory.size(), kFrames - 1);
    EXPECT_EQ(trajectory.back().stamp, make_frame(kFrames - 1).stamp);
}

TEST_F(Method, FramesOfARecordingAreTrackedOneByOneAsARunDoesIt) {
    constexpr std::size_t kFrames = 4;
    const auto frames = run(std::make_unique<FakeSource>(kFrames), Schedule::Pipelined, Pace::EveryFrame);
    ASSERT_EQ(frames.size(), kFrames);
    Recording recording(std::make_unique<FakeSource>(kFrames));
    PoseFusion slam(recording, without_people());
    for (std::size_t i = 0; i < kFrames; ++i) {
        const ProcessedFrame frame = slam.process(recording.load(i));
        EXPECT_EQ(frame.result.T_world_camera.matrix(), frames[i].result.T_world_camera.matrix()) << i;
    }
}

TEST_F(Method, AFrameThatIsRefusedTakesNoPart) {
    PoseFusion slam(small_camera(), without_people());
    const RawFrame raw = make_frame(1);
    const DepthImage depth = to_metres(raw.depth, small_camera().depth_scale);
    slam.process(raw.color, depth, raw.stamp);
    EXPECT_THROW(slam.process(raw.color, depth, raw.stamp), Error) << "a stamp that is not later";
    EXPECT_THROW(slam.process(raw.color, depth, stamp_of(std::nan(""))), Error) << "a stamp that is no number";
    EXPECT_THROW(slam.process(raw.color, DepthImage(4, 4, 1.0f), raw.stamp + std::chrono::seconds(1)), Error)
        << "another size";
    EXPECT_THROW(slam.process(raw.color, depth, raw.stamp + std::chrono::seconds(1), LabelImage(4, 4)), Error)
        << "labels of another size";
    EXPECT_EQ(slam.process(raw.color, depth, raw.stamp + std::chrono::seconds(1)).number, 1u);
    EXPECT_EQ(slam.trajectory().size(), 2u);
}

TEST_F(Method, AcrossAGapInTimeTheCameraHasToBeRecognised) {
    const auto state_after = [](double gap_s) {
        PoseFusion method(small_camera(), without_people());
        double now = 1;
        const auto see = [&] {
            const RawFrame raw = make_frame(0);
            return method.process(raw.color, to_metres(raw.depth, small_camera().depth_scale), stamp_of(now));
        };
        for (int i = 0; i < 25; ++i, now += kPeriod) EXPECT_TRUE(has_pose(see().result.tracking));
        now += gap_s - kPeriod;
        return see().result.tracking;
    };
    EXPECT_EQ(state_after(0.9), TrackingState::Ok);
    EXPECT_EQ(state_after(1.1), TrackingState::Lost) << "even where every point fits";
}

TEST_F(Method, GivenLabelsAreCutOutByTheEngineAlone) {
    PoseFusion slam(small_camera(), without_people()), plain(small_camera(), without_people());
    LabelImage labels(kWidth, kHeight);
    for (int v = 0; v < kHeight; ++v) labels(3, v) = 1, labels(4, v) = 7;
    const RawFrame raw = make_frame(0);
    const DepthImage depth = to_metres(raw.depth, small_camera().depth_scale);
    const ProcessedFrame frame = slam.process(raw.color, depth, raw.stamp, labels);
    EXPECT_EQ(frame.people.segmentation.people, 2);
    EXPECT_TRUE(std::equal(depth.begin(), depth.end(), frame.input.depth.begin()));
    EXPECT_LT(frame.result.surfels, plain.process(raw.color, depth, raw.stamp).result.surfels);
}

TEST_F(Method, SurfelsOfAPersonWhoIsNoticedLateGoWithTheMask) {
    constexpr float kAhead = 0.5f;  ///< of the wall, metres
    PoseFusion slam(small_camera(), without_people());
    LabelImage labels(kWidth, kHeight);
    const auto frame_with_person = [&](std::size_t i) {
        const RawFrame raw = make_frame(i);
        DepthImage depth = to_metres(raw.depth, small_camera().depth_scale);
        for (int v = 6; v < 18; ++v)
            for (int u = 8; u < 22; ++u) depth(u, v) -= kAhead, labels(u, v) = 1;
        return std::pair(raw, depth);
    };
    const auto at_the_person = [&] {
        const std::vector<Surfel> surfels = slam.engine().surfels(false);
        return std::count_if(surfels.begin(), surfels.end(), [](const Surfel& s) { return s.position.z() < 1.4f; });
    };
    for (std::size_t i = 0; i < 3; ++i) {
        const auto [raw, depth] = frame_with_person(i);
        slam.process(raw.color, depth, raw.stamp);
    }
    EXPECT_GT(at_the_person(), 100);
    const auto [raw, depth] = frame_with_person(3);
    slam.process(raw.color, depth, raw.stamp, labels);
    EXPECT_EQ(at_the_person(), 0);
}

/// Finds nobody, but notes what it is told of the camera's motion.
class MotionWitness final : public PeopleFinder {
public:
    explicit MotionWitness(std::vector<float>& seen) : seen_(seen) {}
    Segmentation segment(const Frame&, const std::optional<People>&,
                         const Eigen::Isometry3f& T_previous_current) override {
        seen_.push_back(T_previous_current.translation().norm());
        return {};
    }
    std::string description() const override { return "nobody"; }

private:
    std::vector<float>& seen_;
};

TEST_F(Method, AfterAResetTheMotionIsUnknownAgain) {
    constexpr std::size_t kFrames = 6;
    std::vector<float> seen;
    PoseFusion slam(small_camera(), without_people());
    for (int round = 0; round < 2; ++round) {
        slam.reset(std::make_unique<MotionWitness>(seen));
        for (std::size_t i = 0; i < kFrames; ++i) {
            RawFrame raw = make_frame(i);
            for (std::uint16_t& z : raw.depth) z = static_cast<std::uint16_t>(z - 20 * i);  // it comes nearer
            slam.process(std::move(raw.color), to_metres(raw.depth, small_camera().depth_scale), raw.stamp);
        }
    }
    ASSERT_EQ(seen.size(), 2 * kFrames);
    EXPECT_GT(seen[kFrames - 1], 0.005f) << "the test needs a camera that moves";
    for (std::size_t i = 0; i < kFrames; ++i) EXPECT_EQ(seen[i], seen[kFrames + i]) << i;
    EXPECT_EQ(slam.trajectory().size(), kFrames);
}

}  // namespace
}  // namespace posefusion
