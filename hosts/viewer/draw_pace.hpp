#pragma once
#include <cstdint>

namespace posefusion {

/// Decides when the window is redrawn, and in how much detail: rarely enough not to slow tracking down, and only when
/// something has changed. All times are seconds of one clock.
class DrawPace {
public:
    /// @param shares_queue  drawing and tracking wait for each other on the device
    explicit DrawPace(bool shares_queue) : shares_queue_(shares_queue) {}

    /// Something visible has changed.
    void changed() { changed_ = true; }
    /// There was user input: for a while the window is redrawn as often as possible.
    void touched(double now) { touched_ = now; }
    /// A frame was drawn. @param tracking  whether the tracker is running
    void drawn(double now, bool tracking);
    /// The device has finished it. @param seconds  of device time;  @param surfels  drawn
    void finished(double seconds, std::uint32_t surfels);
    /// Draw every stride-th surfel: 1, unless drawing all of them would delay tracking.
    [[nodiscard]] std::uint32_t stride(std::uint32_t surfels, bool tracking) const;
    /// Seconds until the next frame should be drawn; 0 = now.
    [[nodiscard]] double wait(double now) const;

private:
    bool shares_queue_, changed_ = true;
    double touched_ = 0, last_ = -1e9, earliest_ = -1e9;
    double device_seconds_ = 0, per_surfel_ = 0;
    bool yields_ = false;  // the last frame was drawn while the tracker was waiting
};

}  // namespace posefusion
