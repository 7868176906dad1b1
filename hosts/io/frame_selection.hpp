#pragma once
#include <cstddef>
#include <string>
#include <string_view>

#include "hosts/io/stamp.hpp"

namespace posefusion {

/// The first frame of a recording that is used.
struct FrameStart {
    std::size_t frame = 0;  ///< this one; the first of the recording is 0
    Stamp after{};          ///< else the first one this long after the first frame; 0: `frame` says it

    bool operator==(const FrameStart&) const = default;
};

/// Which frames of a source are used.
struct FrameSelection {
    FrameStart start;
    std::size_t every = 1;  ///< from there on every n-th, at least 1

    bool operator==(const FrameSelection&) const = default;
};

/// "40" for a frame, "1.5s" for seconds.
[[nodiscard]] std::string text_of(const FrameStart& start);
/// The inverse. Throws Error: neither a number of frames nor of seconds, both from 0 on.
[[nodiscard]] FrameStart parse_frame_start(std::string_view text);

}  // namespace posefusion
