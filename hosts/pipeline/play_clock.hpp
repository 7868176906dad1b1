#pragma once
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>

namespace posefusion {

/// The clock by which a recording is played. Tests use their own.
class PlayClock {
public:
    virtual ~PlayClock() = default;
    [[nodiscard]] virtual double seconds() const = 0;
    /// Returns at that time, or earlier when `cancelled` has become true.
    virtual void wait_until(double seconds, const std::function<bool()>& cancelled) = 0;
};

/// Wall-clock time that can be paused. Thread-safe.
class WallClock final : public PlayClock {
public:
    WallClock();
    [[nodiscard]] double seconds() const override;
    void wait_until(double seconds, const std::function<bool()>& cancelled) override;
    void stop();  ///< until go()
    void go();

private:
    [[nodiscard]] double seconds_locked() const;

    mutable std::mutex mutex_;
    std::condition_variable changed_;
    double started_ = 0;  // of the steady clock, seconds; moved on by the duration of each pause
    bool stands_ = false;
    double stood_at_ = 0;
};

}  // namespace posefusion
