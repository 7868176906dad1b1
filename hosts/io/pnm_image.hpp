#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

#include "engine/core/image.hpp"
#include "hosts/io/image_header.hpp"

/// Binary PGM (P5) and PPM (P6) images: https://netpbm.sourceforge.net/doc/pgm.html
namespace posefusion {

struct PnmHeader {
    ImageSize size;
    int channels = 0;         ///< 1 or 3
    int most = 0;             ///< largest value a pixel may have, up to 65535; above 255 it takes two bytes
    std::size_t data_at = 0;  ///< first byte of the pixels; all of them are there
};

/// Whether it is of this family (P1 to P6).
[[nodiscard]] bool is_pnm(ByteView bytes);

/// Throws Error: truncated, damaged, or in text form.
[[nodiscard]] PnmHeader read_pnm_header(ByteView bytes, const std::string& name);

/// The values of a grey image, unchanged.
[[nodiscard]] Image<std::uint16_t> decode_pgm(ByteView bytes, const std::string& name);

/// An image of 8 bits, grey or colour; the largest value becomes 255.
[[nodiscard]] ColorImage decode_ppm(ByteView bytes, const std::string& name);

}  // namespace posefusion
