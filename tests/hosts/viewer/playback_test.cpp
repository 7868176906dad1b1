#include "hosts/viewer/playback.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <thread>

namespace posefusion {
namespace {

using namespace std::chrono_literals;

/// A tracker that does nothing but count.
class Tracker {
public:
    explicit Tracker(Playback& playback)
        : thread_([this, &playback] {
              while (true) {
                  playback.frame_due();
                  if (playback.stopped()) break;
                  ++frames;
                  std::this_thread::sleep_for(1ms);
              }
          }),
          playback_(playback) {}
    ~Tracker() {
        playback_.stop();
        thread_.join();
    }
    std::atomic<int> frames = 0;

private:
    std::thread thread_;
    Playback& playback_;
};

void wait_until_standing(const Playback& playback) {
    for (int i = 0; i < 5000 && !playback.holding(); ++i) std::this_thread::sleep_for(1ms);
    ASSERT_TRUE(playback.holding());
}

TEST(Playback, PausedFromTheStartLetsNothingThroughUntilItPlays) {
    Playback playback(false);
    Tracker tracker(playback);
    wait_until_standing(playback);
    std::this_thread::sleep_for(20ms);
    EXPECT_EQ(tracker.frames, 0);
    playback.play();
    while (tracker.frames < 3) std::this_thread::yield();
    EXPECT_TRUE(playback.playing());
}

TEST(Playback, StepsLetExactlySoManyThroughAndAddUp) {
    Playback playback(false);
    Tracker tracker(playback);
    playback.step(3);
    playback.step(2);
    wait_until_standing(playback);
    EXPECT_EQ(tracker.frames, 5);
    EXPECT_FALSE(playback.playing());
}

TEST(Playback, AStepWhilePlayingPausesAfterIt) {
    Playback playback(true);
    Tracker tracker(playback);
    while (tracker.frames < 2) std::this_thread::yield();
    playback.step();
    wait_until_standing(playback);
    const int stopped_at = tracker.frames;
    std::this_thread::sleep_for(20ms);
    EXPECT_EQ(tracker.frames, stopped_at);
}

TEST(Playback, TheClockStandsWhilePausedAndGoesWhilePlaying) {
    Playback playback(false);
    const double begin = playback.clock().seconds();
    std::this_thread::sleep_for(20ms);
    EXPECT_EQ(playback.clock().seconds(), begin);
    playback.play();
    std::this_thread::sleep_for(20ms);
    EXPECT_GT(playback.clock().seconds(), begin);
    playback.pause();
    const double paused = playback.clock().seconds();
    std::this_thread::sleep_for(20ms);
    EXPECT_EQ(playback.clock().seconds(), paused);
}

TEST(Playback, StoppingWakesWhoeverWaitsAndStartingAgainWorks) {
    Playback playback(false);
    { Tracker tracker(playback); }  // stops it while it waits
    EXPECT_TRUE(playback.stopped());
    playback.start(true);
    EXPECT_FALSE(playback.stopped());
    Tracker tracker(playback);
    while (tracker.frames < 2) std::this_thread::yield();
}

}  // namespace
}  // namespace posefusion
