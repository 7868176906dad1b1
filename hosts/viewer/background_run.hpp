#pragma once
#include <atomic>
#include <optional>
#include <thread>

#include "hosts/run/run_session.hpp"
#include "hosts/viewer/frame_feed.hpp"
#include "hosts/viewer/playback.hpp"

namespace posefusion {

/// A run on its own thread, so that the window need not wait for it.
class BackgroundRun {
public:
    /// All three must outlive this.
    BackgroundRun(RunSession& session, FrameFeed& feed, Playback& playback);
    ~BackgroundRun();  ///< ends the run

    void start();
    /// Stops the run after its current frame and waits for it.
    void stop();
    /// Starts a new run with an empty map. @param playing  false: paused. Throws Error if the run cannot be set up
    /// again
    void restart(bool playing);
    [[nodiscard]] bool ended() const { return ended_; }
    /// The record of the run, once it has ended.
    [[nodiscard]] const RunRecord& record() const { return record_; }

private:
    void correct_feed();

    RunSession& session_;
    FrameFeed& feed_;
    Playback& playback_;
    std::atomic<bool> ended_ = false;
    RunRecord record_;  // owned by the thread until ended_
    std::thread thread_;
};

}  // namespace posefusion
