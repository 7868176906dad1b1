#pragma once
#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "hosts/pipeline/play_clock.hpp"

namespace posefusion {

/// Plays a recording at the rate at which it was recorded, as a camera would deliver it: a frame that is due while the
/// queue is full, or while a later one is due as well, is dropped. Pauses in the recording are played, up to a few
/// seconds each.
class RealTimePace {
public:
    /// @param stamp_of  time stamp of entry i, seconds  @param entries  their number
    RealTimePace(const std::function<double(std::size_t)>& stamp_of, std::size_t entries, PlayClock& clock);

    /// Waits until an entry is due and the queue has room. The first is due at the first call.
    /// @return its index; nullopt at the end of the recording and when cancelled
    [[nodiscard]] std::optional<std::size_t> next(const std::function<bool()>& has_room,
                                                  const std::function<bool()>& cancelled);
    /// Entries dropped so far.
    [[nodiscard]] std::size_t dropped() const { return dropped_; }

private:
    [[nodiscard]] double due(std::size_t entry) const { return *started_ + times_[entry]; }

    std::vector<double> times_;  // of the entries, relative to the first
    std::size_t next_ = 0, dropped_ = 0;
    PlayClock& clock_;
    std::optional<double> started_;  // by the clock
};

/// A camera cannot wait: a frame that arrives while the queue is full is dropped. While the clock is paused nothing is
/// late, and such frames are not counted.
class CameraPace {
public:
    explicit CameraPace(const PlayClock& clock) : clock_(clock) {}

    /// Called for every frame that arrives. @return whether it is processed
    [[nodiscard]] bool take(bool has_room);
    /// Frames dropped so far.
    [[nodiscard]] std::size_t dropped() const { return dropped_; }

private:
    const PlayClock& clock_;
    double last_ = clock_.seconds();  // when the previous frame arrived
    std::size_t dropped_ = 0;
};

}  // namespace posefusion
