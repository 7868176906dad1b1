#include "hosts/pipeline/pipeline.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "hosts/pipeline/motion_prediction.hpp"

namespace posefusion {
namespace {

using namespace std::chrono_literals;

/// An item that counts how many of its kind are alive.
struct Item {
    Item(int n, std::shared_ptr<void> presence) : number(n), token(std::move(presence)) {}
    int number;
    int value = 0;
    std::shared_ptr<void> token;
};

/// A source of `count` numbered items and stages that can be slow, fail or cancel at a chosen item.
struct Harness {
    int count = 40;
    std::array<std::chrono::microseconds, 3> pause{};
    std::array<int, 3> fail_at{-1, -1, -1};
    std::array<int, 3> cancel_at{-1, -1, -1};

    std::vector<int> finished;  ///< values that came out of the sink
    std::atomic<int> alive = 0, most_alive = 0;
    std::atomic<bool> cancel = false;
    std::atomic<int> source_calls = 0;
    int ended = 0;

    void act(std::size_t stage, int number) {
        if (pause[stage] > 0us) std::this_thread::sleep_for(pause[stage]);
        if (number == cancel_at[stage]) cancel = true;
        if (number == fail_at[stage]) throw std::runtime_error("stage " + std::to_string(stage));
    }

    PipelineOutcome run(Schedule schedule) {
        int next = 0;
        Stages<Item> stages;
        stages.source = [&, next]() mutable -> std::optional<Item> {
            ++source_calls;
            if (next == count) return std::nullopt;
            act(0, next);
            const int now = ++alive;
            for (int most = most_alive; now > most && !most_alive.compare_exchange_weak(most, now);) {
            }
            return Item(next++, std::shared_ptr<void>(nullptr, [this](void*) { --alive; }));
        };
        stages.middle = [&](Item& item) {
            act(1, item.number);
            item.value = 10 * item.number;
        };
        stages.sink = [&](Item& item) {
            act(2, item.number);
            finished.push_back(item.value + 1);
        };
        stages.sink_ended = [&] { ++ended; };
        stages.cancelled = [&] { return cancel.load(); };
        return run_pipeline(stages, schedule);
    }

    [[nodiscard]] std::vector<int> expected(int n) const {
        std::vector<int> values;
        for (int i = 0; i < n; ++i) values.push_back(10 * i + 1);
        return values;
    }
};

std::string message_of(const std::exception_ptr& error) {
    if (!error) return "";
    try {
        std::rethrow_exception(error);
    } catch (const std::exception& e) {
        return e.what();
    }
}

class PipelineSchedules : public testing::TestWithParam<Schedule> {};
INSTANTIATE_TEST_SUITE_P(Both, PipelineSchedules, testing::Values(Schedule::Pipelined, Schedule::Sequential),
                         [](const auto& p) { return p.param == Schedule::Pipelined ? "Pipelined" : "Sequential"; });

TEST_P(PipelineSchedules, EveryItemPassesAllStagesInOrder) {
    Harness harness;
    const PipelineOutcome outcome = harness.run(GetParam());
    EXPECT_EQ(harness.finished, harness.expected(40));
    EXPECT_FALSE(outcome.error);
    EXPECT_FALSE(outcome.cancelled);
    EXPECT_EQ(harness.ended, 1);
    EXPECT_EQ(harness.alive, 0);
}

TEST_P(PipelineSchedules, AnEmptySourceEndsAtOnce) {
    Harness harness;
    harness.count = 0;
    EXPECT_FALSE(harness.run(GetParam()).error);
    EXPECT_TRUE(harness.finished.empty());
    EXPECT_EQ(harness.ended, 1);
}

TEST_P(PipelineSchedules, AnErrorInAnyStageKeepsEverythingBeforeIt) {
    for (std::size_t stage = 0; stage < 3; ++stage) {
        Harness harness;
        harness.fail_at[stage] = 17;
        const PipelineOutcome outcome = harness.run(GetParam());
        EXPECT_EQ(harness.finished, harness.expected(17)) << "stage " << stage;
        EXPECT_EQ(message_of(outcome.error), "stage " + std::to_string(stage));
        EXPECT_FALSE(outcome.cancelled);
        EXPECT_LE(harness.source_calls, 17 + 10) << "the reader did not stop";
        EXPECT_EQ(harness.alive, 0);
    }
}

TEST_P(PipelineSchedules, OfSeveralErrorsTheOneOfTheEarliestItemIsReported) {
    Harness harness;
    harness.fail_at = {9, 8, 7};
    harness.pause = {0us, 0us, 2000us};
    EXPECT_EQ(message_of(harness.run(GetParam()).error), "stage 2");
    EXPECT_EQ(harness.finished, harness.expected(7));
}

TEST_P(PipelineSchedules, CancellingInAnyStageKeepsAPrefixAndStopsSoon) {
    for (std::size_t stage = 0; stage < 3; ++stage) {
        Harness harness;
        harness.cancel_at[stage] = 12;
        const PipelineOutcome outcome = harness.run(GetParam());
        EXPECT_TRUE(outcome.cancelled);
        EXPECT_FALSE(outcome.error);
        EXPECT_EQ(harness.finished, harness.expected(static_cast<int>(harness.finished.size())));
        EXPECT_LE(harness.finished.size(), 13u);
        EXPECT_LE(harness.source_calls, 12 + 10);
        EXPECT_EQ(harness.alive, 0);
    }
}

TEST_P(PipelineSchedules, CancelledBeforeTheStartDoesNothing) {
    Harness harness;
    harness.cancel = true;
    EXPECT_TRUE(harness.run(GetParam()).cancelled);
    EXPECT_EQ(harness.source_calls, 0);
}

/// As a camera that gives up waiting: there is no further item, but the run is not complete.
TEST_P(PipelineSchedules, ASourceThatEndsBecauseItIsCancelledIsNotFinished) {
    for (int i = 0; i < 20; ++i) {
        std::atomic<bool> cancel = false;
        int items = 0;
        Stages<int> stages;
        stages.source = [&]() -> std::optional<int> {
            if (items < 3) return items++;
            std::this_thread::sleep_for(1ms);  // the other stages wait for an item
            cancel = true;
            return std::nullopt;
        };
        stages.middle = stages.sink = [](int&) {};
        stages.cancelled = [&] { return cancel.load(); };
        EXPECT_TRUE(run_pipeline(stages, GetParam()).cancelled);
    }
}

TEST(Pipeline, ASlowStageHoldsAtMostThreeItemsPerQueueBack) {
    for (std::size_t stage = 0; stage < 3; ++stage) {
        Harness harness;
        harness.pause[stage] = 1000us;
        EXPECT_FALSE(harness.run(Schedule::Pipelined).error);
        EXPECT_EQ(harness.finished, harness.expected(40));
        // One in the hand of each stage and three in each of the two queues.
        EXPECT_LE(harness.most_alive, 3 + 2 * static_cast<int>(kQueueSlots));
    }
}

TEST(Pipeline, StagesWorkAtTheSameTime) {
    int next = 0;
    std::atomic<int> read = 0, prepared = 0;
    bool overlapped = false;
    Stages<int> stages;
    stages.source = [&]() -> std::optional<int> {
        ++read;
        return next < 5 ? std::optional(next++) : std::nullopt;
    };
    stages.middle = [&](int&) { ++prepared; };
    // While the first item is still in the sink, the two stages before it must get on with later ones.
    stages.sink = [&](int& item) {
        if (item != 0) return;
        const auto give_up = std::chrono::steady_clock::now() + 20s;
        while (!overlapped && std::chrono::steady_clock::now() < give_up) {
            overlapped = read >= 3 && prepared >= 2;
            std::this_thread::yield();
        }
    };
    EXPECT_FALSE(run_pipeline(stages, Schedule::Pipelined).error);
    EXPECT_TRUE(overlapped);
}

/// The feedback of the real run: the middle stage waits for what the sink computed two items earlier.
struct Feedback {
    MotionPrediction motion;
    std::vector<float> seen;
    PipelineOutcome run(Schedule schedule, int count, int fail_at = -1) {
        int next = 0;
        Stages<Item> stages;
        stages.source = [&, next]() mutable -> std::optional<Item> {
            if (next == count) return std::nullopt;
            return Item(next++, nullptr);
        };
        stages.middle = [&](Item& item) {
            const auto n = item.number;
            seen.push_back(motion.predict(static_cast<std::size_t>(n), stamp_of(n), stamp_of(n - 1)).translation().x());
        };
        stages.sink = [&](Item& item) {
            if (item.number == fail_at) throw std::runtime_error("lost");
            Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
            pose.translation().x() = item.number * item.number;
            motion.publish({std::chrono::seconds(item.number), pose, pose});
        };
        stages.sink_ended = [&] { motion.close(); };
        return run_pipeline(stages, schedule);
    }
};

TEST(Pipeline, FeedbackGivesTheSameAnswersInBothSchedules) {
    Feedback pipelined, sequential;
    EXPECT_FALSE(pipelined.run(Schedule::Pipelined, 200).error);
    EXPECT_FALSE(sequential.run(Schedule::Sequential, 200).error);
    EXPECT_EQ(pipelined.seen, sequential.seen);
    // x = n^2: from 7 to 8 the camera moved by 15, and that is what is expected from 9 to 10.
    EXPECT_FLOAT_EQ(pipelined.seen[10], 15.f);
}

TEST(Pipeline, AStageThatWaitsForTheSinkWakesUpWhenTheSinkFails) {
    for (int fail_at = 0; fail_at < 8; ++fail_at) {
        Feedback feedback;
        EXPECT_EQ(message_of(feedback.run(Schedule::Pipelined, 100, fail_at).error), "lost");
    }
}

}  // namespace
}  // namespace posefusion
