#include "hosts/io/image_file.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "engine/core/error.hpp"
#include "hosts/io/output_file.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;
using Bytes = std::vector<std::uint8_t>;

/// Compressed files above this are no images of a camera.
constexpr std::uintmax_t kMaxFileBytes = std::uintmax_t{256} << 20;

enum class Format { Png, Jpeg };

/// What the header says, before anything is decoded.
struct Header {
    Format format = Format::Png;
    ImageSize size;
    int bits = 0;      ///< per channel
    int channels = 0;  ///< of a PNG; a palette counts as 3
};

[[noreturn]] void fail(const fs::path& file, const std::string& what) { throw Error(file.string() + ": " + what); }

std::string text(ImageSize size) { return std::to_string(size.width) + "x" + std::to_string(size.height); }

Bytes read_bytes(const fs::path& file) {
    std::error_code error;
    if (!fs::exists(file, error)) fail(file, "image file is missing");
    if (!fs::is_regular_file(file, error)) fail(file, "is not an image file");
    const auto length = fs::file_size(file, error);
    if (error) fail(file, "cannot be read: " + error.message());
    if (length == 0) fail(file, "image file is empty");
    if (length > kMaxFileBytes) fail(file, "is too large for an image");
    Bytes bytes(static_cast<std::size_t>(length));
    errno = 0;
    std::ifstream in(file, std::ios::binary);
    in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!in) fail(file, std::string("cannot be read: ") + (errno != 0 ? std::strerror(errno) : "file ends early"));
    return bytes;
}

int big_endian(const Bytes& bytes, std::size_t at, int count) {
    std::uint32_t value = 0;
    for (int i = 0; i < count; ++i) value = value << 8 | bytes[at + static_cast<std::size_t>(i)];
    return static_cast<int>(std::min<std::uint32_t>(value, std::numeric_limits<int>::max()));
}

constexpr std::array<std::uint8_t, 8> kPngSignature{0x89, 'P', 'N', 'G', '\r', '\n', 0x1A, '\n'};
constexpr std::array<std::uint8_t, 12> kPngEnd{0, 0, 0, 0, 'I', 'E', 'N', 'D', 0xAE, 0x42, 0x60, 0x82};

/// PNG specification, 11.2.2: the IHDR chunk comes first.
Header png_header(const fs::path& file, const Bytes& bytes) {
    constexpr std::size_t kIhdrEnd = 33;
    if (bytes.size() < kIhdrEnd || std::memcmp(&bytes[12], "IHDR", 4) != 0) fail(file, "PNG image is truncated");
    // Decoders fill what is missing with grey; a recording that ends in the middle of a file must not pass for depth.
    if (std::search(bytes.begin(), bytes.end(), kPngEnd.begin(), kPngEnd.end()) == bytes.end())
        fail(file, "PNG image is truncated");
    constexpr std::array<int, 7> kChannels{1, 0, 3, 3, 2, 0, 4};  // by colour type
    const std::size_t color_type = bytes[25];
    if (color_type >= kChannels.size() || kChannels[color_type] == 0) fail(file, "PNG header is damaged");
    return {Format::Png, {big_endian(bytes, 16, 4), big_endian(bytes, 20, 4)}, bytes[24], kChannels[color_type]};
}

/// ITU-T T.81, B.2: walks over the marker segments to the start of frame.
Header jpeg_header(const fs::path& file, const Bytes& bytes) {
    constexpr std::uint8_t kEndOfImage = 0xD9, kStartOfScan = 0xDA;
    const auto is_start_of_frame = [](int m) { return m >= 0xC0 && m <= 0xCF && m != 0xC4 && m != 0xC8 && m != 0xCC; };
    constexpr std::array<std::uint8_t, 2> kEnd{0xFF, kEndOfImage};
    if (std::find_end(bytes.begin() + 2, bytes.end(), kEnd.begin(), kEnd.end()) == bytes.end())
        fail(file, "JPEG image is truncated");
    for (std::size_t at = 2; at + 9 < bytes.size();) {
        if (bytes[at] != 0xFF) break;
        const int marker = bytes[at + 1];
        if (marker == 0xFF) {
            ++at;  // fill byte
            continue;
        }
        if (is_start_of_frame(marker))
            return {Format::Jpeg,
                    {big_endian(bytes, at + 7, 2), big_endian(bytes, at + 5, 2)},
                    bytes[at + 4],
                    bytes[at + 9]};
        if (marker == kStartOfScan) break;
        at += 2 + static_cast<std::size_t>(big_endian(bytes, at + 2, 2));
    }
    fail(file, "JPEG header is damaged");
}

Header read_header(const fs::path& file, const Bytes& bytes) {
    if (bytes.size() >= kPngSignature.size() && std::equal(kPngSignature.begin(), kPngSignature.end(), bytes.begin()))
        return png_header(file, bytes);
    if (bytes.size() > 3 && bytes[0] == 0xFF && bytes[1] == 0xD8) return jpeg_header(file, bytes);
    fail(file, "is neither a PNG nor a JPEG image");
}

cv::Mat decode(const fs::path& file, const Bytes& bytes, ImageSize size, int flags) {
    cv::Mat image;
    try {
        image = cv::imdecode(bytes, flags | cv::IMREAD_IGNORE_ORIENTATION);
    } catch (const cv::Exception&) {
        image.release();
    }
    if (image.empty() || image.cols != size.width || image.rows != size.height) fail(file, "image is damaged");
    return image;
}

ColorImage decode_color(const fs::path& file, const Bytes& bytes, const Header& header) {
    if (header.bits > 8)
        fail(file,
             "is a " + std::to_string(header.bits) + "-bit image, expected 8-bit colour (is this a depth image?)");
    const cv::Mat bgr = decode(file, bytes, header.size, cv::IMREAD_COLOR);
    ColorImage color(header.size.width, header.size.height);
    cv::Mat rgb(bgr.rows, bgr.cols, CV_8UC3, color.data());
    cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
    return color;
}

void expect_size(const fs::path& file, ImageSize found, ImageSize expected) {
    if (!(found == expected))
        fail(file, "image is " + text(found) + ", expected " + text(expected) + " as in the camera file");
}

std::string encode(const char* extension, const cv::Mat& image, const std::vector<int>& parameters = {}) {
    Bytes bytes;
    if (!cv::imencode(extension, image, bytes, parameters))
        throw Error(std::string("image cannot be encoded as ") + extension);
    return {bytes.begin(), bytes.end()};
}

cv::Mat to_bgr(const ColorImage& image) {
    const cv::Mat rgb(image.height(), image.width(), CV_8UC3, const_cast<Rgb8*>(image.data()));
    cv::Mat bgr;
    cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
    return bgr;
}

}  // namespace

ImageSize image_file_size(const fs::path& file) { return read_header(file, read_bytes(file)).size; }

ColorImage read_color(const fs::path& file, ImageSize size) {
    const Bytes bytes = read_bytes(file);
    const Header header = read_header(file, bytes);
    expect_size(file, header.size, size);
    return decode_color(file, bytes, header);
}

ColorImage read_photo(const fs::path& file, int max_side) {
    const Bytes bytes = read_bytes(file);
    const Header header = read_header(file, bytes);
    if (std::max(header.size.width, header.size.height) > max_side)
        fail(file, "image is " + text(header.size) + ", more than " + std::to_string(max_side) + " pixels a side");
    return decode_color(file, bytes, header);
}

DepthImage read_depth(const fs::path& file, ImageSize size, float depth_scale) {
    const Bytes bytes = read_bytes(file);
    const Header header = read_header(file, bytes);
    if (header.format != Format::Png || header.bits != 16 || header.channels != 1)
        fail(file, "is not a 16-bit grey PNG (is this a colour image?)");
    expect_size(file, header.size, size);
    const cv::Mat raw = decode(file, bytes, size, cv::IMREAD_UNCHANGED);
    if (raw.type() != CV_16UC1) fail(file, "image is damaged");

    RawDepth values(size.width, size.height);
    for (int v = 0; v < size.height; ++v) std::copy_n(raw.ptr<std::uint16_t>(v), size.width, &values(0, v));
    return to_metres(values, depth_scale);
}

DepthImage to_metres(const RawDepth& raw, float depth_scale) {
    constexpr std::uint16_t kSaturated = 65535;
    const float metres = 1.0f / depth_scale;
    DepthImage depth(raw.width(), raw.height());
    for (std::size_t i = 0; i < raw.size(); ++i) depth[i] = raw[i] == kSaturated ? 0.0f : static_cast<float>(raw[i]) * metres;
    return depth;
}

LabelImage read_labels(const fs::path& file, ImageSize size) {
    const Bytes bytes = read_bytes(file);
    const Header header = read_header(file, bytes);
    if (header.format != Format::Png || header.bits > 8 || header.channels != 1)
        fail(file, "mask is not an 8-bit grey PNG");
    expect_size(file, header.size, size);
    const cv::Mat raw = decode(file, bytes, size, cv::IMREAD_UNCHANGED);
    if (raw.type() != CV_8UC1) fail(file, "mask is not an 8-bit grey PNG");
    LabelImage labels(raw.cols, raw.rows);
    for (int v = 0; v < raw.rows; ++v) std::copy_n(raw.ptr<std::uint8_t>(v), raw.cols, &labels(0, v));
    return labels;
}

std::string encode_png(const ColorImage& image) { return encode(".png", to_bgr(image)); }

std::string encode_jpeg(const ColorImage& image, int quality) {
    return encode(".jpg", to_bgr(image), {cv::IMWRITE_JPEG_QUALITY, quality});
}

void write_png(const fs::path& file, const ColorImage& image) { write_file_atomically(file, encode_png(image)); }

void write_jpeg(const fs::path& file, const ColorImage& image, int quality) {
    write_file_atomically(file, encode_jpeg(image, quality));
}

void write_labels(const fs::path& file, const LabelImage& labels) {
    const cv::Mat image(labels.height(), labels.width(), CV_8UC1, const_cast<std::uint8_t*>(labels.data()));
    write_file_atomically(file, encode(".png", image));
}

void write_depth(const fs::path& file, const DepthImage& depth, float depth_scale) {
    cv::Mat image(depth.height(), depth.width(), CV_16UC1);
    for (int v = 0; v < depth.height(); ++v) {
        auto* row = image.ptr<std::uint16_t>(v);
        for (int u = 0; u < depth.width(); ++u) {
            const float value = std::round(depth(u, v) * depth_scale);
            const bool fits = value >= 0 && value < 65535.0f;
            row[u] = fits ? static_cast<std::uint16_t>(value) : std::uint16_t{0};
        }
    }
    write_file_atomically(file, encode(".png", image));
}

}  // namespace posefusion
