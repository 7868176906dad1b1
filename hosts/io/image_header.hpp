#pragma once
#include <filesystem>
#include <string>

#include "hosts/io/input_file.hpp"

/// Headers of image files, read before memory is allocated or a decoder is called.
namespace posefusion {

struct ImageSize {
    int width = 0, height = 0;
    friend bool operator==(const ImageSize&, const ImageSize&) = default;
};

/// Pixels along a side: the header of a larger image is assumed to be damaged.
inline constexpr int kMaxImageSide = 8192;

/// As 640x480.
[[nodiscard]] std::string size_text(ImageSize size);

enum class ImageFormat { Png, Jpeg, Tiff, WebP, Bmp, Pnm, Exr };

struct ImageHeader {
    ImageFormat format = ImageFormat::Png;
    ImageSize size;
    int bits = 0;           ///< per channel
    int channels = 0;       ///< 1 = grey; a palette counts as 3
    bool is_float = false;  ///< values are floating point numbers
};

/// Does the file's name end like that of an image: .png, .jpg, .tiff ..., in letters of either case?
[[nodiscard]] bool has_image_ending(const std::filesystem::path& file);

/// PNG, JPEG, TIFF, WebP, BMP, PGM, PPM or OpenEXR, recognised by the bytes, not by a name. Throws Error: none of them,
/// or truncated, or a header that is damaged. @param name  what the bytes are, for the message of an Error
[[nodiscard]] ImageHeader read_image_header(ByteView bytes, const std::filesystem::path& name);

}  // namespace posefusion
