#include "hosts/io/frame_source.hpp"

#include <algorithm>

#include "engine/core/number_text.hpp"

namespace posefusion {

void FrameSource::warn_of_pauses() {
    constexpr Stamp kLongInterval = std::chrono::seconds(2), kLongPause = std::chrono::seconds(10);
    const auto in_seconds = [](Stamp time) { return fixed_text(to_seconds(time), 1) + " s"; };
    std::vector<Stamp> intervals;
    std::size_t longest = 0;
    for (std::size_t i = 1; i < facts_.frames.size(); ++i) {
        intervals.push_back(facts_.frames[i].stamp - facts_.frames[i - 1].stamp);
        if (intervals[longest] < intervals.back()) longest = i - 1;
    }
    if (intervals.empty()) return;
    const Stamp pause = intervals[longest];
    const auto middle = intervals.begin() + static_cast<std::ptrdiff_t>((intervals.size() - 1) / 2);
    std::nth_element(intervals.begin(), middle, intervals.end());
    if (*middle > kLongInterval)
        facts_.warnings.push_back(facts_.location + ": its frames are " + in_seconds(*middle) +
                                  " apart; if the time stamps are no seconds, say what they are with --time-unit");
    else if (pause > kLongPause)
        facts_.warnings.push_back(facts_.location + ": nothing was recorded for " + in_seconds(pause) +
                                  " after frame " + std::to_string(longest));
}

}  // namespace posefusion
