#include "hosts/viewer/draw_pace.hpp"

#include <algorithm>

namespace posefusion {
namespace {

constexpr double kShortest = 1.0 / 60;  // between two frames
constexpr double kLongest = 0.5;        // between two frames in which nothing has changed
constexpr double kAttentive = 0.5;      // so long after the user did something
constexpr double kShare = 0.15;         // most of the device's time that drawing takes while tracking waits for it

}  // namespace

void DrawPace::drawn(double now, double device_seconds, bool tracking) {
    changed_ = false;
    last_ = now;
    earliest_ = now + kShortest;
    if (shares_queue_ && tracking) earliest_ = std::max(earliest_, now + device_seconds * (1 / kShare - 1));
}

double DrawPace::wait(double now) const {
    const bool wanted = changed_ || now - touched_ < kAttentive;
    const double due = wanted ? earliest_ : std::max(earliest_, last_ + kLongest);
    return std::max(0.0, due - now);
}

}  // namespace posefusion
