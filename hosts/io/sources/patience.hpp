#pragma once
#include <chrono>
#include <functional>
#include <string>

#include "hosts/io/frame_source.hpp"

/// Waiting for what a camera or another program gives.
namespace posefusion {

/// So soon a wait that nobody wants any more ends.
inline constexpr std::chrono::milliseconds kLongestPause{50};

/// Waits until there is something, in short pauses.
/// @param cancelled  asked before each pause
/// @param wait       (milliseconds) -> bool: waits at most so long, less if disturbed; whether there is something
/// @return false: there was nothing for all of `patience`. Throws SourceCancelled naming `location`.
template <class Wait>
[[nodiscard]] bool wait_with_patience(std::chrono::milliseconds patience, const std::function<bool()>& cancelled,
                                      const std::string& location, Wait&& wait) {
    const auto given_up = std::chrono::steady_clock::now() + patience;
    do {
        if (cancelled()) throw SourceCancelled(location + ": interrupted while waiting for it");
        if (wait(kLongestPause)) return true;
    } while (std::chrono::steady_clock::now() < given_up);
    return false;
}

}  // namespace posefusion
