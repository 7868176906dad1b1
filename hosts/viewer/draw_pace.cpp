#include "hosts/viewer/draw_pace.hpp"

#include <algorithm>
#include <cmath>

namespace posefusion {
namespace {

constexpr double kShortest = 1.0 / 60;  // between two frames
constexpr double kLongest = 0.5;        // between two frames in which nothing has changed
constexpr double kAttentive = 0.5;      // as often as possible for this long after user input
constexpr double kShare = 0.1;     // largest share of the device's time that drawing takes while tracking waits for it
constexpr double kBudget = 0.015;  // device time of one frame while tracking waits for it, seconds
constexpr std::uint32_t kCoarsest = 16;

}  // namespace

void DrawPace::drawn(double now, bool tracking) {
    changed_ = false;
    last_ = now;
    earliest_ = now + kShortest;
    yields_ = shares_queue_ && tracking;
    if (yields_) earliest_ = std::max(earliest_, now + device_seconds_ / kShare);
}

void DrawPace::finished(double seconds, std::uint32_t surfels) {
    device_seconds_ = seconds;
    if (surfels > 0) per_surfel_ = seconds / surfels;
    if (yields_) earliest_ = std::max(earliest_, last_ + seconds / kShare);
}

std::uint32_t DrawPace::stride(std::uint32_t surfels, bool tracking) const {
    if (!shares_queue_ || !tracking || surfels == 0) return 1;
    const double wanted = std::ceil(per_surfel_ * surfels / kBudget);
    return static_cast<std::uint32_t>(std::clamp(wanted, 1.0, static_cast<double>(std::min(kCoarsest, surfels))));
}

double DrawPace::wait(double now) const {
    const bool wanted = changed_ || now - touched_ < kAttentive;
    const double due = wanted ? earliest_ : std::max(earliest_, last_ + kLongest);
    return std::max(0.0, due - now);
}

}  // namespace posefusion
