#pragma once
#include <cstdint>

namespace posefusion {

/// When the window is drawn next, and with how much detail: rarely enough not to slow tracking down, and only when
/// there is something new. All times in seconds of one clock.
class DrawPace {
public:
    /// @param shares_queue  drawing and tracking wait for each other on the device
    explicit DrawPace(bool shares_queue) : shares_queue_(shares_queue) {}

    /// Something has changed that is to be seen.
    void changed() { changed_ = true; }
    /// The user did something: for a while the window is drawn as often as possible.
    void touched(double now) { touched_ = now; }
    /// A frame was drawn. @param tracking  the tracker runs
    void drawn(double now, bool tracking);
    /// The device has finished it. @param seconds  of device time;  @param surfels  drawn
    void finished(double seconds, std::uint32_t surfels);
    /// Every stride-th of the surfels is to be drawn: 1, except where tracking would have to wait for all of them.
    [[nodiscard]] std::uint32_t stride(std::uint32_t surfels, bool tracking) const;
    /// Seconds until the next frame should be drawn; 0 = now.
    [[nodiscard]] double wait(double now) const;

private:
    bool shares_queue_, changed_ = true;
    double touched_ = 0, last_ = -1e9, earliest_ = -1e9;
    double device_seconds_ = 0, per_surfel_ = 0;
    bool yields_ = false;  // the last frame was drawn while the tracker waited
};

}  // namespace posefusion
