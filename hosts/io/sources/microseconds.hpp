#pragma once
#include <cstdint>
#include <cstdio>

#include "hosts/io/frame_source.hpp"

/// Time stamps that are counted in microseconds.
namespace posefusion {

inline constexpr std::uint64_t kMicrosecondsPerSecond = 1'000'000;

[[nodiscard]] constexpr double seconds_of(std::uint64_t microseconds) {
    return static_cast<double>(microseconds) / static_cast<double>(kMicrosecondsPerSecond);
}

/// A frame of that time, its stamp written with all six decimals.
[[nodiscard]] inline FrameEntry frame_at(std::uint64_t microseconds) {
    char text[32];
    std::snprintf(text, sizeof text, "%llu.%06llu",
                  static_cast<unsigned long long>(microseconds / kMicrosecondsPerSecond),
                  static_cast<unsigned long long>(microseconds % kMicrosecondsPerSecond));
    return {seconds_of(microseconds), text};
}

}  // namespace posefusion
