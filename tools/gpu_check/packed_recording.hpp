#pragma once
#include <filesystem>
#include <vector>

#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"

/// The recording in a packed folder: what tools/gpu_check/pack wrote, read without OpenCV.
namespace posefusion {

/// One frame as the engine takes it.
struct PackedFrame {
    ColorImage color;
    DepthImage depth;   ///< metres
    LabelImage labels;  ///< people, known beforehand
};

struct PackedRecording {
    Intrinsics camera;
    std::vector<PackedFrame> frames;
};

/// Reads `folder`/recording.json and the images that it names. Throws Error.
/// @param max_frames  the first so many; 0 = all
[[nodiscard]] PackedRecording read_packed_recording(const std::filesystem::path& folder, std::size_t max_frames);

/// The same view with `width` columns, a power of two times more or fewer: every second pixel is taken, or pixels are
/// put between them. Good for measuring time; a camera of that size would see more.
[[nodiscard]] PackedRecording resized(const PackedRecording& recording, int width);

}  // namespace posefusion
