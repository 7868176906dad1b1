#include "hosts/pipeline/play_clock.hpp"

#include <algorithm>
#include <chrono>

namespace posefusion {
namespace {

constexpr double kLook = 0.05;  ///< seconds between two checks whether a wait is cancelled

double steady_seconds() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

WallClock::WallClock() : started_(steady_seconds()) {}

double WallClock::seconds_locked() const { return stands_ ? stood_at_ : steady_seconds() - started_; }

double WallClock::seconds() const {
    const std::lock_guard lock(mutex_);
    return seconds_locked();
}

void WallClock::wait_until(double seconds, const std::function<bool()>& cancelled) {
    std::unique_lock lock(mutex_);
    while (!cancelled()) {
        const double left = seconds - seconds_locked();
        if (left <= 0) return;
        changed_.wait_for(lock, std::chrono::duration<double>(std::min(left, kLook)));
    }
}

void WallClock::stop() {
    const std::lock_guard lock(mutex_);
    if (stands_) return;
    stood_at_ = seconds_locked();
    stands_ = true;
}

void WallClock::go() {
    {
        const std::lock_guard lock(mutex_);
        if (!stands_) return;
        started_ = steady_seconds() - stood_at_;
        stands_ = false;
    }
    changed_.notify_all();
}

}  // namespace posefusion
