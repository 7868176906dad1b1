#pragma once
#include <condition_variable>
#include <cstddef>
#include <mutex>

#include "hosts/pipeline/play_clock.hpp"

namespace posefusion {

/// Play, pause, step: a gate before the tracker. While it is closed, earlier stages fill their queues and wait. In real
/// time the recording's clock is paused as well.
class Playback {
public:
    explicit Playback(bool playing);

    /// Called by the tracker's thread before each frame; returns when it may continue.
    void frame_due();
    [[nodiscard]] bool stopped() const;
    [[nodiscard]] PlayClock& clock() { return clock_; }

    /// Called by the window's thread.
    void play();
    void pause();
    void step(std::size_t frames = 1);  ///< lets this many more frames pass, then pauses
    void stop();                        ///< ends the run; waiting threads continue
    void start(bool playing);           ///< for a new run
    [[nodiscard]] bool playing() const;
    /// Whether the tracker waits at the gate: nothing changes until play() or step().
    [[nodiscard]] bool holding() const;

private:
    mutable std::mutex mutex_;
    std::condition_variable changed_;
    bool playing_, stopped_ = false, waiting_ = false;
    std::size_t steps_ = 0;
    WallClock clock_;
};

}  // namespace posefusion
