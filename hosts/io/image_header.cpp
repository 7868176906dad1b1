#include "hosts/io/image_header.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <iterator>
#include <limits>
#include <string_view>

#include "engine/core/error.hpp"
#include "hosts/io/exr_image.hpp"
#include "hosts/io/pnm_image.hpp"
#include "hosts/io/tiff_image.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& name, const std::string& what) { throw Error(name.string() + ": " + what); }

/// `count` (at most 4) bytes as a number; what does not fit into an int is as large as an int can be.
int number(ByteView bytes, std::size_t at, int count, bool big_endian) {
    std::uint32_t value = 0;
    for (int i = 0; i < count; ++i) {
        const int from = big_endian ? i : count - 1 - i;
        value = value << 8 | bytes[at + static_cast<std::size_t>(from)];
    }
    return static_cast<int>(std::min<std::uint32_t>(value, std::numeric_limits<int>::max()));
}
int big_endian(ByteView bytes, std::size_t at, int count) { return number(bytes, at, count, true); }
int little_endian(ByteView bytes, std::size_t at, int count) { return number(bytes, at, count, false); }

bool starts_with(ByteView bytes, std::string_view text) {
    return bytes.size() >= text.size() && std::memcmp(bytes.data(), text.data(), text.size()) == 0;
}

constexpr std::string_view kPngSignature = "\x89PNG\r\n\x1A\n";
constexpr std::array<std::uint8_t, 12> kPngEnd{0, 0, 0, 0, 'I', 'E', 'N', 'D', 0xAE, 0x42, 0x60, 0x82};

/// PNG specification, 11.2.2: the IHDR chunk comes first.
ImageHeader png_header(ByteView bytes, const fs::path& name) {
    constexpr std::size_t kIhdrEnd = 33;
    if (bytes.size() < kIhdrEnd || std::memcmp(&bytes[12], "IHDR", 4) != 0) refuse(name, "PNG image is truncated");
    // Decoders fill what is missing with grey; a file that was cut off must not be taken for depth.
    if (std::search(bytes.begin(), bytes.end(), kPngEnd.begin(), kPngEnd.end()) == bytes.end())
        refuse(name, "PNG image is truncated");
    constexpr std::array<int, 7> kChannels{1, 0, 3, 3, 2, 0, 4};  // by colour type
    const std::size_t color_type = bytes[25];
    if (color_type >= kChannels.size() || kChannels[color_type] == 0) refuse(name, "PNG header is damaged");
    return {ImageFormat::Png, {big_endian(bytes, 16, 4), big_endian(bytes, 20, 4)}, bytes[24], kChannels[color_type]};
}

/// ITU-T T.81, B.2: walks over the marker segments to the start of frame.
ImageHeader jpeg_header(ByteView bytes, const fs::path& name) {
    constexpr std::uint8_t kEndOfImage = 0xD9, kStartOfScan = 0xDA;
    const auto is_start_of_frame = [](int m) { return m >= 0xC0 && m <= 0xCF && m != 0xC4 && m != 0xC8 && m != 0xCC; };
    constexpr std::array<std::uint8_t, 2> kEnd{0xFF, kEndOfImage};
    if (std::find_end(bytes.begin() + 2, bytes.end(), kEnd.begin(), kEnd.end()) == bytes.end())
        refuse(name, "JPEG image is truncated");
    for (std::size_t at = 2; at + 9 < bytes.size();) {
        if (bytes[at] != 0xFF) break;
        const int marker = bytes[at + 1];
        if (marker == 0xFF) {
            ++at;  // fill byte
            continue;
        }
        if (is_start_of_frame(marker))
            return {ImageFormat::Jpeg,
                    {big_endian(bytes, at + 7, 2), big_endian(bytes, at + 5, 2)},
                    bytes[at + 4],
                    bytes[at + 9]};
        if (marker == kStartOfScan) break;
        at += 2 + static_cast<std::size_t>(big_endian(bytes, at + 2, 2));
    }
    refuse(name, "JPEG header is damaged");
}

/// RFC 9649.
ImageHeader webp_header(ByteView bytes, const fs::path& name) {
    constexpr std::size_t kHeaderBytes = 30, kRiffBytes = 8;
    if (bytes.size() < kHeaderBytes || bytes.size() - kRiffBytes < static_cast<std::size_t>(little_endian(bytes, 4, 4)))
        refuse(name, "WebP image is truncated");
    const auto kind = bytes.subspan(12, 4);
    constexpr int kMask14 = 0x3FFF;
    ImageHeader header{ImageFormat::WebP, {}, 8, 3};
    if (starts_with(kind, "VP8X"))
        header.size = {little_endian(bytes, 24, 3) + 1, little_endian(bytes, 27, 3) + 1};
    else if (starts_with(kind, "VP8L"))
        header.size = {(little_endian(bytes, 21, 2) & kMask14) + 1, (little_endian(bytes, 22, 3) >> 6 & kMask14) + 1};
    else if (starts_with(kind, "VP8 "))
        header.size = {little_endian(bytes, 26, 2) & kMask14, little_endian(bytes, 28, 2) & kMask14};
    else
        refuse(name, "WebP header is damaged");
    return header;
}

/// BITMAPFILEHEADER and BITMAPINFOHEADER.
ImageHeader bmp_header(ByteView bytes, const fs::path& name) {
    constexpr std::size_t kHeaderBytes = 54;
    constexpr int kUncompressed = 0, kBitFields = 3;
    if (bytes.size() < kHeaderBytes) refuse(name, "BMP image is truncated");
    const auto signed_height = static_cast<std::int32_t>(static_cast<std::uint32_t>(little_endian(bytes, 22, 2)) |
                                                         static_cast<std::uint32_t>(little_endian(bytes, 24, 2)) << 16);
    const int bits = little_endian(bytes, 28, 2), compression = little_endian(bytes, 30, 4);
    if (signed_height == std::numeric_limits<std::int32_t>::min()) refuse(name, "BMP header is damaged");
    const ImageHeader header{ImageFormat::Bmp, {little_endian(bytes, 18, 4), std::abs(signed_height)}, 8, 3};
    if (compression != kUncompressed && compression != kBitFields)
        refuse(name, "is a compressed BMP image, which is not read; save it as PNG");
    const auto pixels_at = static_cast<std::uint64_t>(little_endian(bytes, 10, 4));
    const std::uint64_t row =
        (static_cast<std::uint64_t>(header.size.width) * static_cast<std::uint64_t>(bits) + 31) / 32 * 4;
    if (bytes.size() < pixels_at || bytes.size() - pixels_at < row * static_cast<std::uint64_t>(header.size.height))
        refuse(name, "BMP image is truncated");
    return header;
}

}  // namespace

std::string size_text(ImageSize size) { return std::to_string(size.width) + "x" + std::to_string(size.height); }

bool has_image_ending(const fs::path& file) {
    constexpr std::string_view kEndings[] = {".png", ".jpg", ".jpeg", ".tif", ".tiff", ".webp",
                                             ".bmp", ".pgm", ".ppm",  ".pnm", ".exr"};
    std::string ending = file.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return std::find(std::begin(kEndings), std::end(kEndings), ending) != std::end(kEndings);
}

ImageHeader read_image_header(ByteView bytes, const fs::path& name) {
    if (starts_with(bytes, kPngSignature)) return png_header(bytes, name);
    if (starts_with(bytes, "\xFF\xD8") && bytes.size() > 3) return jpeg_header(bytes, name);
    if (is_tiff(bytes)) return read_tiff_header(bytes, name.string());
    if (starts_with(bytes, "RIFF") && bytes.size() > 12 && starts_with(bytes.subspan(8), "WEBP"))
        return webp_header(bytes, name);
    if (is_exr(bytes)) return {ImageFormat::Exr, exr_size(bytes, name.string()), 32, 1, true};
    if (is_pnm(bytes)) {
        const PnmHeader pnm = read_pnm_header(bytes, name.string());
        return {ImageFormat::Pnm, pnm.size, pnm.most > 255 ? 16 : 8, pnm.channels};
    }
    if (starts_with(bytes, "BM")) return bmp_header(bytes, name);
    refuse(name, "is neither a PNG nor a JPEG image, nor TIFF, WebP, BMP, PGM, PPM or EXR");
}

}  // namespace posefusion
