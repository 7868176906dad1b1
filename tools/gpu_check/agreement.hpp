#pragma once
#include <filesystem>
#include <string>

#include "tools/gpu_check/replay.hpp"

/// A device has to give what the CPU driver gave when the folder was packed.
namespace posefusion {

/// What counts as the same. Sums run in another order and multiply-adds are fused on another device, so that poses
/// differ by rounding, which a hundred frames enlarge, the more the fewer pixels there are: the CPU driver at another
/// vector width differs from itself by 0.28 mm and 0.005 deg at 320x240. A kernel that is wrong differs by millimetres
/// within a few frames.
struct AgreementLimits {
    double translation_mm = 0.1;   ///< of any frame's camera, 640 pixels wide
    double rotation_deg = 0.01;    ///< of any frame's camera, 640 pixels wide
    double surfels_percent = 1.0;  ///< of the map, all and stable
    /// For images of another width: poses of smaller ones may differ in inverse proportion to the number of pixels.
    [[nodiscard]] static AgreementLimits for_width(int width);
};

struct Agreement {
    double translation_mm = 0, rotation_deg = 0;  ///< the largest of all frames
    double surfels_percent = 0, stable_percent = 0;
    bool within = false;
};

/// The poses and map sizes of the CPU driver for one image size, a file in the packed folder.
void write_expected(const Replay& replay, const std::filesystem::path& file);
/// Throws Error if the file cannot be used.
[[nodiscard]] Replay read_expected(const std::filesystem::path& file);

/// @param found  may be of fewer frames; the size of its map is compared only when it is of all
[[nodiscard]] Agreement compare(const Replay& found, const Replay& expected, const AgreementLimits& limits);

}  // namespace posefusion
