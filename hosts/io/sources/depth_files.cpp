#include "hosts/io/sources/depth_files.hpp"

#include <algorithm>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

/// SUN3D's PNG images: of the 16 bits of a value in millimetres the upper three come last.
constexpr int kRotation = 3;

std::uint16_t rotate_back(std::uint16_t value) {
    constexpr int kBits = 16;
    return static_cast<std::uint16_t>(value >> kRotation | value << (kBits - kRotation));
}

/// What is nearer than 16 m has at most the last of the upper three bits. Plain millimetres, of which one value in four
/// would look like that, are spread evenly.
bool is_rotated(const RawDepth& depth) {
    constexpr std::uint16_t kLowBits = (1u << kRotation) - 1;
    const auto measured = std::count_if(depth.begin(), depth.end(), [](std::uint16_t d) { return d != 0; });
    const auto fitting =
        std::count_if(depth.begin(), depth.end(), [](std::uint16_t d) { return d != 0 && (d & kLowBits) <= 1; });
    return fitting > measured * 9 / 10;
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
    } else if (header && coding == DepthCoding::MaybeRotated) {
        const auto depth = first_readable(files, [this](const fs::path& file) { return read_raw_depth(file, size_); });
        rotated_ = depth && is_rotated(*depth);
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
