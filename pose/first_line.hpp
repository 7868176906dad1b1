#pragma once
#include <string>
#include <string_view>

namespace posefusion {

/// The first line of a message: those of ONNX Runtime and OpenCV may span several lines, an Error is one line.
[[nodiscard]] inline std::string first_line(std::string_view text) {
    return std::string(text.substr(0, text.find('\n')));
}

}  // namespace posefusion
