#include "hosts/viewer/background_run.hpp"

#include <algorithm>

namespace posefusion {

BackgroundRun::BackgroundRun(RunSession& session, FrameFeed& feed, Playback& playback)
    : session_(session), feed_(feed), playback_(playback) {}

BackgroundRun::~BackgroundRun() { stop(); }

void BackgroundRun::start() {
    ended_ = false;
    thread_ = std::thread([this] {
        Console console;
        RunHooks hooks;
        hooks.frame_due = [this] { playback_.frame_due(); };
        hooks.frame_done = [this](const ScheduledFrame& frame) {
            feed_.publish(frame);
            const auto& loops = frame.result.loops;
            if (std::any_of(loops.begin(), loops.end(), [](const LoopEvent& event) { return event.accepted; })) {
                feed_.correct(session_.slam().trajectory());
            }
        };
        hooks.cancelled = [this] { return playback_.stopped(); };
        hooks.clock = &playback_.clock();
        record_ = session_.run(console, hooks);
        ended_ = true;
    });
}

void BackgroundRun::stop() {
    playback_.stop();
    if (thread_.joinable()) thread_.join();
}

void BackgroundRun::restart(bool playing) {
    stop();
    session_.restart();
    feed_.clear();
    playback_.start(playing);
    start();
}

}  // namespace posefusion
