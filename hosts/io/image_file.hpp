#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/image.hpp"
#include "hosts/io/image_header.hpp"
#include "hosts/io/input_file.hpp"

/// Image files: colour in PNG, JPEG, WebP, BMP, TIFF or PPM, depth in PNG, TIFF, PGM or OpenEXR, masks in PNG. All
/// readers check the header before they decode: a file of another size or type than requested is rejected before memory
/// is allocated. They throw Error naming the file for anything missing, truncated or damaged.
namespace posefusion {

/// Depth in the units of a sensor or file; Camera::depth_scale units are one metre, 0 and 65535 no measurement.
using RawDepth = Image<std::uint16_t>;

/// Depth in floating point is kept in steps of 0.2 mm, up to 13.1 m.
inline constexpr float kFloatDepthScale = 5000.0f;

/// Without decoding the pixels.
[[nodiscard]] ImageHeader image_file_header(const std::filesystem::path& file);
[[nodiscard]] ImageSize image_file_size(const std::filesystem::path& file);

/// 8-bit colour or grey (r = g = b) of exactly `size`.
[[nodiscard]] ColorImage read_color(const std::filesystem::path& file, ImageSize size);
/// The same for any size up to `max_side` pixels per side: for photographs.
[[nodiscard]] ColorImage read_photo(const std::filesystem::path& file, int max_side = 8192);
/// 16-bit grey image of exactly `size`; value / `depth_scale` = metres. 0 and 65535 (7-Scenes) mean no measurement.
[[nodiscard]] DepthImage read_depth(const std::filesystem::path& file, ImageSize size, float depth_scale);
/// 16-bit grey image of exactly `size`, values as they are, or a float one, quantised().
/// @param float_metre  value of one metre in a float image
[[nodiscard]] RawDepth read_raw_depth(const std::filesystem::path& file, ImageSize size, float float_metre = 1.0f);
/// A float image of exactly `size`, values as they are.
[[nodiscard]] Image<float> read_float_depth(const std::filesystem::path& file, ImageSize size);
/// In units of 1 / kFloatDepthScale metres; what is not positive, not finite or too far becomes 0.
/// @param metre  value of one metre in `depth`
[[nodiscard]] RawDepth quantised(const Image<float>& depth, float metre);
/// Value / `depth_scale` = metres. 0 and 65535 (7-Scenes) mean no measurement.
[[nodiscard]] DepthImage to_metres(const RawDepth& raw, float depth_scale);
/// 8-bit grey PNG of exactly `size`: 0 static, 1..n person.
[[nodiscard]] LabelImage read_labels(const std::filesystem::path& file, ImageSize size);
/// 8- or 16-bit grey PNG of exactly `size`, values as they are.
[[nodiscard]] Image<std::uint16_t> read_wide_labels(const std::filesystem::path& file, ImageSize size);

/// The same from memory. @param name  what the bytes are, for the message of an Error
[[nodiscard]] ImageSize image_size(ByteView bytes, const std::string& name);
[[nodiscard]] ColorImage decode_color(ByteView bytes, const std::string& name, ImageSize size);
[[nodiscard]] RawDepth decode_raw_depth(ByteView bytes, const std::string& name, ImageSize size,
                                        float float_metre = 1.0f);

[[nodiscard]] std::string encode_png(const ColorImage& image);
[[nodiscard]] std::string encode_jpeg(const ColorImage& image, int quality);

/// Written atomically; throw Error.
void write_png(const std::filesystem::path& file, const ColorImage& image);
void write_jpeg(const std::filesystem::path& file, const ColorImage& image, int quality);
void write_labels(const std::filesystem::path& file, const LabelImage& labels);
/// 16-bit PNG, metres * depth_scale rounded; what does not fit becomes 0.
void write_depth(const std::filesystem::path& file, const DepthImage& depth, float depth_scale);
void write_raw_depth(const std::filesystem::path& file, const RawDepth& depth);

}  // namespace posefusion
