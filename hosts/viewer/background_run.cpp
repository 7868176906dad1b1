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
            if (frame.result.map_change != MapChange::None ||
                std::any_of(loops.begin(), loops.end(), [](const LoopEvent& event) { return event.accepted; })) {
                correct_feed();
            }
            if (!frame.result.objects.empty() && feed_.models_wanted())
                feed_.publish_models(session_.object_maps(false));
        };
        hooks.cancelled = [this] { return playback_.stopped(); };
        hooks.clock = &playback_.clock();
        record_ = session_.run(console, hooks);
        record_.judge();
        if (record_.pieces.size() > 1) correct_feed();  // to the main one
        ended_ = true;
    });
}

void BackgroundRun::correct_feed() {
    const Slam& slam = session_.slam();
    const std::vector<Eigen::Isometry3d> all = slam.trajectory();
    const std::vector<std::uint32_t> numbers = slam.frames();
    const std::size_t earlier = slam.frames_processed() - feed_.frames_done();  // of a loaded map
    std::vector<std::size_t> frames;
    std::vector<Eigen::Isometry3d> poses;
    for (std::size_t i = 0; i < all.size(); ++i) {
        if (numbers[i] < earlier) continue;
        frames.push_back(numbers[i] - earlier);
        poses.push_back(all[i]);
    }
    feed_.correct(frames, poses);
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
