#pragma once
#include <filesystem>
#include <memory>

#include "hosts/io/frame_source.hpp"

namespace posefusion {

/// A recording of an Azure Kinect, .mkv as its k4arecorder writes it: tracks COLOR and DEPTH, and calibration.json,
/// by which depth is registered to colour. Throws Error: it cannot be used.
[[nodiscard]] std::unique_ptr<FrameSource> open_azure(const std::filesystem::path& file, const SourceOptions& options);

}  // namespace posefusion
