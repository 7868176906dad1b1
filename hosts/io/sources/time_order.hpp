#pragma once
#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "hosts/io/stamp.hpp"

/// Handling of time stamps that repeat, fall or are unset, for all formats.
namespace posefusion {

/// "1 frame", "12 frames"
[[nodiscard]] inline std::string count_text(std::size_t n, const std::string& what) {
    return std::to_string(n) + " " + what + (n == 1 ? "" : "s");
}

/// The time of an image of which only the index is known: 30 per second, the first at 0.
[[nodiscard]] constexpr Stamp stamp_of_number(std::size_t number) {
    constexpr std::size_t kFramesPerSecond = 30, kMicrosecondsPerSecond = 1'000'000;
    return std::chrono::microseconds((number * kMicrosecondsPerSecond + kFramesPerSecond / 2) / kFramesPerSecond);
}

/// Accesses the stamp of an item.
struct MemberStamp {
    template <class Item>
    [[nodiscard]] Stamp operator()(const Item& item) const {
        return item.stamp;
    }
};

template <class Item, class StampOf = MemberStamp>
[[nodiscard]] std::vector<Stamp> stamps_of(const std::vector<Item>& items, StampOf stamp_of = {}) {
    std::vector<Stamp> stamps;
    stamps.reserve(items.size());
    for (const Item& item : items) stamps.push_back(stamp_of(item));
    return stamps;
}

/// Whether at most half of the stamps differ: the driver does not set them (usually all are 0).
[[nodiscard]] inline bool say_nothing(std::vector<Stamp> stamps) {
    std::sort(stamps.begin(), stamps.end());
    const auto different = static_cast<std::size_t>(std::unique(stamps.begin(), stamps.end()) - stamps.begin());
    return stamps.size() > 1 && 2 * different <= stamps.size();
}

/// Ascending stamps, each once (the first item with it counts). Corrections are added to `warnings`.
/// @param where, what  for the warnings: the file; "frame", "line"
template <class Item, class StampOf = MemberStamp>
void put_in_order(std::vector<Item>& items, const std::string& where, const std::string& what,
                  std::vector<std::string>& warnings, StampOf stamp_of = {}) {
    const auto earlier = [&](const Item& a, const Item& b) { return stamp_of(a) < stamp_of(b); };
    if (!std::is_sorted(items.begin(), items.end(), earlier)) {
        warnings.push_back(where + ": time stamps are not in order; they have been sorted");
        std::stable_sort(items.begin(), items.end(), earlier);
    }
    const auto end = std::unique(items.begin(), items.end(),
                                 [&](const Item& a, const Item& b) { return stamp_of(a) == stamp_of(b); });
    if (end == items.end()) return;
    warnings.push_back(where + ": " + count_text(static_cast<std::size_t>(items.end() - end), what) +
                       " with a time stamp that was there before left out");
    items.erase(end, items.end());
}

}  // namespace posefusion
