#include "hosts/pipeline/real_time.hpp"

#include <algorithm>

namespace posefusion {

RealTimePace::RealTimePace(const std::function<double(std::size_t)>& stamp_of, std::size_t entries, PlayClock& clock)
    : clock_(clock) {
    constexpr double kLongestPause = 5;  // seconds; a clock that was adjusted must not stop the run for hours
    double cut = 0;
    for (std::size_t i = 0; i < entries; ++i) {
        if (i > 0) cut += std::max(0.0, stamp_of(i) - stamp_of(i - 1) - kLongestPause);
        times_.push_back(stamp_of(i) - stamp_of(0) - cut);
    }
}

std::optional<std::size_t> RealTimePace::next(const std::function<bool()>& has_room,
                                              const std::function<bool()>& cancelled) {
    if (!started_) started_ = clock_.seconds();
    while (next_ < times_.size() && !cancelled()) {
        clock_.wait_until(due(next_), cancelled);
        if (cancelled()) break;
        const std::size_t entry = next_++;
        const bool stale = next_ < times_.size() && due(next_) <= clock_.seconds();
        if (!stale && has_room()) return entry;
        ++dropped_;
    }
    return std::nullopt;
}

bool CameraPace::take(bool has_room) {
    const double now = clock_.seconds();
    if (!has_room && now > last_) ++dropped_;
    last_ = now;
    return has_room;
}

}  // namespace posefusion
