#pragma once

namespace posefusion {

/// When the window is drawn next: at most so often that the tracker does not feel it, and only when there is something
/// new. All times in seconds of one clock.
class DrawPace {
public:
    /// @param shares_queue  drawing and tracking wait for each other on the device
    explicit DrawPace(bool shares_queue) : shares_queue_(shares_queue) {}

    /// Something has changed that is to be seen.
    void changed() { changed_ = true; }
    /// The user did something: what he sees follows at once for a while.
    void touched(double now) { touched_ = now; }
    /// A frame was drawn. @param device_seconds  that the device spent on it; @param tracking  the tracker runs
    void drawn(double now, double device_seconds, bool tracking);
    /// Seconds until the next frame should be drawn; 0 = now.
    [[nodiscard]] double wait(double now) const;

private:
    bool shares_queue_, changed_ = true;
    double touched_ = 0, last_ = -1e9, earliest_ = -1e9;
};

}  // namespace posefusion
