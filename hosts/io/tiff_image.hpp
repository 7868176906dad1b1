#pragma once
#include <cstdint>
#include <string>

#include "engine/core/image.hpp"
#include "hosts/io/image_header.hpp"

/// TIFF images: grey of 16 bits or in floating point for depth, any of 8 bits for colour. The first image of a file
/// counts. All throw Error that starts with `name`: truncated, damaged, of another kind.
namespace posefusion {

[[nodiscard]] bool is_tiff(ByteView bytes);

[[nodiscard]] ImageHeader read_tiff_header(ByteView bytes, const std::string& name);

[[nodiscard]] Image<std::uint16_t> decode_tiff_short(ByteView bytes, const std::string& name);
[[nodiscard]] Image<float> decode_tiff_float(ByteView bytes, const std::string& name);
[[nodiscard]] ColorImage decode_tiff_color(ByteView bytes, const std::string& name);

}  // namespace posefusion
