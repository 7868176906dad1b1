#include "hosts/io/sources/depth_files.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>

#include "engine/core/error.hpp"
#include "engine/core/median.hpp"
#include "engine/core/number_text.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

/// SUN3D's PNG images: of the 16 bits of a value in millimetres the upper three come last.
constexpr int kRotation = 3;

std::uint16_t rotate_back(std::uint16_t value) {
    constexpr int kBits = 16;
    return static_cast<std::uint16_t>(value >> kRotation | value << (kBits - kRotation));
}

/// What is nearer than 16 m has at most the last of the upper three bits. Of plain millimetres one value in four would
/// look like that. Throws Error where the image has too few different values to tell.
bool is_rotated(const RawDepth& depth) {
    constexpr std::uint16_t kLowBits = (1u << kRotation) - 1;
    constexpr std::size_t kFewestValues = 10;  // all of them by chance: one in a million
    const std::set<std::uint16_t> values(depth.begin(), depth.end());
    if (values.size() <= kFewestValues) throw Error("too few different values");
    const auto fitting =
        std::count_if(values.begin(), values.end(), [](std::uint16_t d) { return (d & kLowBits) <= 1; });
    return fitting > static_cast<std::ptrdiff_t>(values.size() * 9 / 10);
}

/// The measured values of a float image. Throws Error where there are none.
std::vector<float> measured_values(const fs::path& file, ImageSize size) {
    const Image<float> depth = read_float_depth(file, size);
    std::vector<float> measured;
    std::copy_if(depth.begin(), depth.end(), std::back_inserter(measured),
                 [](float d) { return d > 0 && std::isfinite(d); });
    if (measured.empty()) throw Error("nothing measured");
    return measured;
}

/// In a wrong unit float depth is too far to be kept at all, so that nothing would remain that could be judged later.
/// Throws Error.
void expect_within_reach(const std::vector<fs::path>& files, ImageSize size, float metre, const std::string& folder) {
    auto measured = first_readable(files, [size](const fs::path& file) { return measured_values(file, size); });
    if (!measured) return;
    const float median = upper_median(*measured);
    if (quantised(Image<float>(1, 1, median), metre)[0] == 0)
        throw Error(folder + ": the median of its float depth is " +
                    fixed_text(static_cast<double>(median / metre), 2) +
                    " m, too far to be kept, or too near; if it is not in metres, set depth_scale in the camera file, "
                    "1000 for millimetres (--camera FILE)");
}

}  // namespace

DepthFiles::DepthFiles(CameraDescription& camera, DepthCoding coding, const std::vector<fs::path>& files,
                       const std::string& folder, std::vector<std::string>& warnings) {
    const auto header = first_readable(files, image_file_header);
    size_ = header ? header->size : ImageSize{camera.camera.intrinsics.width, camera.camera.intrinsics.height};
    if (camera.depth && camera.depth->intrinsics.width == 0) {
        camera.depth->intrinsics.width = size_.width;
        camera.depth->intrinsics.height = size_.height;
    }
    registration_ = registration_for(camera, header ? std::optional(size_) : std::nullopt, folder, warnings);
    if (header && header->is_float) {
        if (camera.says_depth_scale) float_metre_ = camera.camera.depth_scale;
        camera.camera.depth_scale = kFloatDepthScale;
        expect_within_reach(files, size_, float_metre_, folder);
    } else if (header && coding == DepthCoding::MaybeRotated) {
        rotated_ = first_readable(files, [this](const fs::path& file) {
                       return is_rotated(read_raw_depth(file, size_));
                   }).value_or(false);
        if (rotated_) warnings.push_back(folder + ": the bits of its depth values are rotated by three, as in SUN3D");
    }
    depth_scale_ = camera.camera.depth_scale;
}

RawDepth DepthFiles::read(const fs::path& file) const {
    RawDepth depth = read_raw_depth(file, size_, float_metre_);
    if (rotated_) std::transform(depth.begin(), depth.end(), depth.begin(), rotate_back);
    return registration_ ? registration_->apply(depth, depth_scale_) : depth;
}

}  // namespace posefusion
