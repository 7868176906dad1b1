#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/image.hpp"

/// PNG and JPEG files. All readers look at the header before they decode: a file of another size or type than asked for
/// is refused without memory being taken. They throw Error naming the file for anything missing, truncated or damaged.
namespace posefusion {

struct ImageSize {
    int width = 0, height = 0;
    friend bool operator==(const ImageSize&, const ImageSize&) = default;
};

/// Depth as a sensor or a file counts it; Camera::depth_scale units are one metre, 0 and 65535 no measurement.
using RawDepth = Image<std::uint16_t>;

/// Size written in the header of a PNG or JPEG file.
[[nodiscard]] ImageSize image_file_size(const std::filesystem::path& file);

/// 8-bit colour (or grey) PNG or JPEG of exactly `size`.
[[nodiscard]] ColorImage read_color(const std::filesystem::path& file, ImageSize size);
/// 8-bit colour (or grey) PNG or JPEG of any size up to `max_side` pixels a side: for photographs.
[[nodiscard]] ColorImage read_photo(const std::filesystem::path& file, int max_side = 8192);
/// 16-bit grey PNG of exactly `size`; value / `depth_scale` = metres. 0 and 65535 (7-Scenes) mean no measurement.
[[nodiscard]] DepthImage read_depth(const std::filesystem::path& file, ImageSize size, float depth_scale);
/// Value / `depth_scale` = metres. 0 and 65535 (7-Scenes) mean no measurement.
[[nodiscard]] DepthImage to_metres(const RawDepth& raw, float depth_scale);
/// 8-bit grey PNG of exactly `size`: 0 static, 1..n person.
[[nodiscard]] LabelImage read_labels(const std::filesystem::path& file, ImageSize size);

[[nodiscard]] std::string encode_png(const ColorImage& image);
[[nodiscard]] std::string encode_jpeg(const ColorImage& image, int quality);

/// Written atomically; throw Error.
void write_png(const std::filesystem::path& file, const ColorImage& image);
void write_jpeg(const std::filesystem::path& file, const ColorImage& image, int quality);
void write_labels(const std::filesystem::path& file, const LabelImage& labels);
/// 16-bit PNG, metres * depth_scale rounded; what does not fit becomes 0.
void write_depth(const std::filesystem::path& file, const DepthImage& depth, float depth_scale);

}  // namespace posefusion
