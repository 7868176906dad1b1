#include "hosts/viewer/playback.hpp"

namespace posefusion {

Playback::Playback(bool playing) : playing_(playing) {
    if (!playing) clock_.stop();
}

void Playback::frame_due() {
    std::unique_lock lock(mutex_);
    waiting_ = true;
    changed_.wait(lock, [&] { return playing_ || steps_ > 0 || stopped_; });
    waiting_ = false;
    if (steps_ > 0 && --steps_ == 0 && !playing_) clock_.stop();
}

bool Playback::stopped() const {
    const std::lock_guard lock(mutex_);
    return stopped_;
}

void Playback::play() {
    {
        const std::lock_guard lock(mutex_);
        playing_ = true;
        steps_ = 0;
        clock_.go();
    }
    changed_.notify_all();
}

void Playback::pause() {
    const std::lock_guard lock(mutex_);
    playing_ = false;
    steps_ = 0;
    clock_.stop();
}

void Playback::step(std::size_t frames) {
    {
        const std::lock_guard lock(mutex_);
        playing_ = false;
        steps_ += frames;
        clock_.go();
    }
    changed_.notify_all();
}

void Playback::stop() {
    {
        const std::lock_guard lock(mutex_);
        stopped_ = true;
    }
    changed_.notify_all();
}

void Playback::start(bool playing) {
    const std::lock_guard lock(mutex_);
    stopped_ = false;
    playing_ = playing;
    steps_ = 0;
    if (playing)
        clock_.go();
    else
        clock_.stop();
}

bool Playback::playing() const {
    const std::lock_guard lock(mutex_);
    return playing_ || steps_ > 0;
}

bool Playback::holding() const {
    const std::lock_guard lock(mutex_);
    return waiting_ && !playing_ && steps_ == 0;
}

}  // namespace posefusion
