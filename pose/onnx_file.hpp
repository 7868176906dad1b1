#pragma once
#include <filesystem>

#include "pose/runtime.hpp"

namespace posefusion {

/// The image size that an ONNX model declares for its first input; zeros if it accepts any size or the file
/// cannot be read. (OpenCV's importer does not report it.)
[[nodiscard]] InputSize declared_input_size(const std::filesystem::path& onnx);

}  // namespace posefusion
