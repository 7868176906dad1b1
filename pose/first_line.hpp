#pragma once
#include <string>
#include <string_view>

namespace posefusion {

/// The first line of a message: those of ONNX Runtime and OpenCV may have several, an Error has one.
[[nodiscard]] inline std::string first_line(std::string_view text) {
    return std::string(text.substr(0, text.find('\n')));
}

}  // namespace posefusion
