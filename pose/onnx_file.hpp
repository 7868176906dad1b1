#pragma once
#include <filesystem>

#include "pose/runtime.hpp"

namespace posefusion {

/// The image size that an ONNX model declares for its first input; zeros where any size goes or nothing can be read.
/// OpenCV's importer knows it but does not tell.
[[nodiscard]] InputSize declared_input_size(const std::filesystem::path& onnx);

}  // namespace posefusion
