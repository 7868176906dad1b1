#include "hosts/pipeline/real_time.hpp"

#include <utility>

namespace posefusion {

RealTimePace::RealTimePace(std::function<double(std::size_t)> stamp_of, std::size_t entries, PlayClock& clock)
    : stamp_of_(std::move(stamp_of)), entries_(entries), clock_(clock) {}

double RealTimePace::due(std::size_t entry) const { return *started_ + stamp_of_(entry) - stamp_of_(0); }

std::optional<std::size_t> RealTimePace::next(const std::function<bool()>& has_room,
                                              const std::function<bool()>& cancelled) {
    if (!started_) started_ = clock_.seconds();
    while (next_ < entries_ && !cancelled()) {
        clock_.wait_until(due(next_), cancelled);
        if (cancelled()) break;
        const std::size_t entry = next_++;
        const bool stale = next_ < entries_ && due(next_) <= clock_.seconds();
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
