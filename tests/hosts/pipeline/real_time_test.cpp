#include "hosts/pipeline/real_time.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

#include "hosts/pipeline/pipeline.hpp"

namespace posefusion {
namespace {

/// Stands still but for what is waited for and what the test lets pass.
class FakeClock final : public PlayClock {
public:
    [[nodiscard]] double seconds() const override { return now_; }
    void wait_until(double seconds, const std::function<bool()>& cancelled) override {
        if (!cancelled() && seconds > now_) now_ = seconds;
    }
    void pass(double seconds) { now_ = now_ + seconds; }

private:
    std::atomic<double> now_ = 100;
};

constexpr double kStart = 1305031102.25;  // stamps of a recording do not start at 0
constexpr double kPeriod = 1.0 / 16;      // exact in binary

double stamp(std::size_t entry) { return kStart + kPeriod * static_cast<double>(entry); }
bool yes() { return true; }
bool no() { return false; }

TEST(CameraPace, TakesWhatThereIsRoomForAndCountsTheRest) {
    FakeClock clock;
    CameraPace pace(clock);
    for (const bool has_room : {true, false, false, true}) {
        clock.pass(kPeriod);
        EXPECT_EQ(pace.take(has_room), has_room);
    }
    EXPECT_EQ(pace.dropped(), 2u);
}

TEST(CameraPace, WhatComesWhileTheClockStandsIsDroppedButNotCounted) {
    FakeClock clock;
    CameraPace pace(clock);
    for (int i = 0; i < 3; ++i) EXPECT_FALSE(pace.take(false));
    EXPECT_EQ(pace.dropped(), 0u);
    clock.pass(kPeriod);
    EXPECT_FALSE(pace.take(false));
    EXPECT_EQ(pace.dropped(), 1u);
}

TEST(RealTimePace, DropsNothingAndKeepsTheRecordedRateWhileThereIsTime) {
    FakeClock clock;
    const double begin = clock.seconds();
    RealTimePace pace(stamp, 5, clock);
    for (std::size_t i = 0; i < 5; ++i) {
        ASSERT_EQ(pace.next(yes, no), i);
        EXPECT_DOUBLE_EQ(clock.seconds() - begin, kPeriod * static_cast<double>(i));
        clock.pass(0.9 * kPeriod);
    }
    EXPECT_EQ(pace.next(yes, no), std::nullopt);
    EXPECT_EQ(pace.dropped(), 0u);
}

/// A clock that was set while it recorded, or a recording that was paused.
TEST(RealTimePace, APauseOfHoursTakesSeconds) {
    FakeClock clock;
    const double begin = clock.seconds();
    RealTimePace pace([](std::size_t entry) { return stamp(entry) + (entry < 3 ? 0 : 7200); }, 5, clock);
    for (std::size_t i = 0; i < 5; ++i) ASSERT_EQ(pace.next(yes, no), i);
    EXPECT_LT(clock.seconds() - begin, 10);
    EXPECT_GT(clock.seconds() - begin, 1) << "it is a pause still";
    EXPECT_EQ(pace.dropped(), 0u);
}

TEST(RealTimePace, WhoeverComesLateGetsTheNewestFrameAndTheRestIsDropped) {
    FakeClock clock;
    RealTimePace pace(stamp, 10, clock);
    ASSERT_EQ(pace.next(yes, no), 0u);
    clock.pass(3.5 * kPeriod);  // 1, 2 and 3 are due by now
    EXPECT_EQ(pace.next(yes, no), 3u);
    EXPECT_EQ(pace.dropped(), 2u);
    EXPECT_EQ(pace.next(yes, no), 4u);
    EXPECT_EQ(pace.dropped(), 2u);
}

TEST(RealTimePace, AFrameWithoutRoomIsDroppedWhenItIsDueAndNotMadeUpFor) {
    FakeClock clock;
    const double begin = clock.seconds();
    RealTimePace pace(stamp, 4, clock);
    int asked = 0;
    const auto room_for_the_third = [&] { return ++asked == 3; };
    EXPECT_EQ(pace.next(room_for_the_third, no), 2u);
    EXPECT_DOUBLE_EQ(clock.seconds() - begin, 2 * kPeriod);
    EXPECT_EQ(pace.dropped(), 2u);
    EXPECT_EQ(pace.next(no, no), std::nullopt) << "the last one, too";
    EXPECT_EQ(pace.dropped(), 3u);
}

TEST(RealTimePace, FarTooLateStillPlaysTheLastFrame) {
    FakeClock clock;
    RealTimePace pace(stamp, 100, clock);
    ASSERT_EQ(pace.next(yes, no), 0u);
    clock.pass(1e6);
    EXPECT_EQ(pace.next(yes, no), 99u);
    EXPECT_EQ(pace.dropped(), 98u);
    EXPECT_EQ(pace.next(yes, no), std::nullopt);
}

TEST(RealTimePace, CancellingEndsItWithoutCountingWhatWasNotDue) {
    FakeClock clock;
    RealTimePace pace(stamp, 5, clock);
    EXPECT_EQ(pace.next(yes, yes), std::nullopt);
    EXPECT_EQ(pace.dropped(), 0u);
}

/// The sink takes three and a half periods per item. Time passes only there, so that the test does not depend on the
/// machine.
TEST(RealTimePipeline, ASlowPipelineDropsAtItsEntranceAndItsLatencyStaysBounded) {
    constexpr std::size_t kEntries = 200;
    struct Item {
        std::size_t entry;
    };
    for (const Schedule schedule : {Schedule::Sequential, Schedule::Pipelined}) {
        FakeClock clock;
        RealTimePace pace(stamp, kEntries, clock);
        Entrance entrance;
        std::vector<std::size_t> done;
        Stages<Item> stages;
        stages.entrance = [&](const Entrance& e) { entrance = e; };
        stages.source = [&]() -> std::optional<Item> {
            const auto entry = pace.next(entrance.has_room, entrance.closed);
            if (!entry) return std::nullopt;
            return Item{*entry};
        };
        stages.middle = [](Item&) {};
        stages.sink = [&](Item& item) {
            done.push_back(item.entry);
            clock.pass(3.5 * kPeriod);
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        };
        const PipelineOutcome outcome = run_pipeline(stages, schedule);
        EXPECT_FALSE(outcome.error);
        EXPECT_EQ(done.size() + pace.dropped(), kEntries) << "every frame is processed or counted";
        EXPECT_GT(pace.dropped(), 0u);
        EXPECT_TRUE(std::is_sorted(done.begin(), done.end()));
        if (schedule == Schedule::Sequential) {
            EXPECT_LE(done.size(), kEntries / 3 + 2);
        }
    }
}

TEST(RealTimePipeline, NeverHoldsMoreThanTheSlots) {
    constexpr std::size_t kEntries = 100;
    struct Item {
        std::size_t entry;
    };
    FakeClock clock;  // everything is due the moment it is asked for
    RealTimePace pace(stamp, kEntries, clock);
    Entrance entrance;
    std::atomic<bool> go = false;
    std::vector<std::size_t> done;
    Stages<Item> stages;
    stages.entrance = [&](const Entrance& e) { entrance = e; };
    stages.source = [&]() -> std::optional<Item> {
        const auto entry = pace.next(entrance.has_room, entrance.closed);
        if (!entry) {
            go = true;  // the recording is over before the sink has taken anything
            return std::nullopt;
        }
        return Item{*entry};
    };
    stages.middle = [](Item&) {};
    stages.sink = [&](Item& item) {
        while (!go) std::this_thread::yield();
        done.push_back(item.entry);
    };
    EXPECT_FALSE(run_pipeline(stages, Schedule::Pipelined).error);
    // two queues, and one item in the hands of each of the last two stages
    EXPECT_LE(done.size(), 2 * kQueueSlots + 2);
    EXPECT_EQ(done.size() + pace.dropped(), kEntries);
}

TEST(WallClock, StandsStillWhileStoppedAndGoesOnFromThere) {
    WallClock clock;
    clock.stop();
    const double stopped = clock.seconds();
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    EXPECT_EQ(clock.seconds(), stopped);
    clock.go();
    const double gone_on = clock.seconds();
    EXPECT_GE(gone_on, stopped);
    EXPECT_LT(gone_on, stopped + 0.25);
    clock.wait_until(stopped + 0.05, no);
    EXPECT_GE(clock.seconds(), stopped + 0.05);
}

TEST(WallClock, AWaitEndsWhenItIsCancelledEvenIfTheClockStands) {
    WallClock clock;
    clock.stop();
    std::atomic<bool> cancelled = false;
    std::jthread canceller([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        cancelled = true;
    });
    clock.wait_until(1e9, [&] { return cancelled.load(); });
    EXPECT_TRUE(cancelled);
}

}  // namespace
}  // namespace posefusion
