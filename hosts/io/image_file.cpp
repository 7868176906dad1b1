#include "hosts/io/image_file.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "engine/core/error.hpp"
#include "hosts/io/exr_image.hpp"
#include "hosts/io/output_file.hpp"
#include "hosts/io/pnm_image.hpp"
#include "hosts/io/tiff_image.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

/// Larger files are not images of a camera.
constexpr std::uintmax_t kMaxImageBytes = std::uintmax_t{256} << 20;

[[noreturn]] void fail(const fs::path& file, const std::string& what) { throw Error(file.string() + ": " + what); }

ByteBuffer read_bytes(const fs::path& file) {
    std::error_code error;
    if (!fs::exists(file, error)) fail(file, "image file is missing");
    if (!fs::is_regular_file(file, error)) fail(file, "is not an image file");
    const auto length = fs::file_size(file, error);
    if (error) fail(file, "cannot be read: " + error.message());
    if (length == 0) fail(file, "image file is empty");
    if (length > kMaxImageBytes) fail(file, "is too large for an image");
    ByteBuffer bytes(static_cast<std::size_t>(length));
    errno = 0;
    std::ifstream in(file, std::ios::binary);
    in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (!in) fail(file, std::string("cannot be read: ") + (errno != 0 ? std::strerror(errno) : "file ends early"));
    return bytes;
}

cv::Mat decode(const fs::path& file, ByteView bytes, ImageSize size, int flags) {
    cv::Mat image;
    try {
        const cv::Mat view(1, static_cast<int>(bytes.size()), CV_8UC1, const_cast<std::uint8_t*>(bytes.data()));
        image = cv::imdecode(view, flags | cv::IMREAD_IGNORE_ORIENTATION);
    } catch (const cv::Exception&) {
        image.release();
    }
    if (image.empty() || image.cols != size.width || image.rows != size.height) fail(file, "image is damaged");
    return image;
}

/// The advice for the message.
constexpr const char* kDepthKinds = "export depth as 16-bit grey PNG, TIFF or PGM, or as float TIFF or EXR in metres";

ColorImage decode_color(const fs::path& file, ByteView bytes, const ImageHeader& header) {
    if (header.bits > 8)
        fail(file, "is a " + std::to_string(header.bits) + "-bit " + (header.is_float ? "float " : "") +
                       "image, expected 8-bit colour (is this a depth image?)");
    if (header.format == ImageFormat::Pnm) return decode_ppm(bytes, file.string());
    if (header.format == ImageFormat::Tiff) return decode_tiff_color(bytes, file.string());
    const cv::Mat bgr = decode(file, bytes, header.size, cv::IMREAD_COLOR);
    ColorImage color(header.size.width, header.size.height);
    cv::Mat rgb(bgr.rows, bgr.cols, CV_8UC3, color.data());
    cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
    return color;
}

void expect_size(const fs::path& file, ImageSize found, ImageSize expected) {
    if (!(found == expected))
        fail(file, "image is " + size_text(found) + ", expected " + size_text(expected) + " as in the camera file");
}

template <class Value>
Image<Value> pixels_of(const cv::Mat& grey) {
    Image<Value> image(grey.cols, grey.rows);
    for (int v = 0; v < grey.rows; ++v) std::copy_n(grey.ptr<Value>(v), grey.cols, &image(0, v));
    return image;
}

/// Of a file whose header says: one channel of floats.
Image<float> decode_float(ByteView bytes, const std::string& name, const ImageHeader& header) {
    return header.format == ImageFormat::Exr ? decode_exr_depth(bytes, name) : decode_tiff_float(bytes, name);
}

std::string encode(const char* extension, const cv::Mat& image, const std::vector<int>& parameters = {}) {
    ByteBuffer bytes;
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

ImageHeader image_file_header(const fs::path& file) { return read_image_header(read_bytes(file), file); }

ImageSize image_file_size(const fs::path& file) { return image_file_header(file).size; }

ColorImage read_color(const fs::path& file, ImageSize size) {
    return decode_color(read_bytes(file), file.string(), size);
}

ColorImage read_photo(const fs::path& file, int max_side) {
    const ByteBuffer bytes = read_bytes(file);
    const ImageHeader header = read_image_header(bytes, file);
    if (std::max(header.size.width, header.size.height) > max_side)
        fail(file, "image is " + size_text(header.size) + ", more than " + std::to_string(max_side) + " pixels a side");
    return decode_color(file, bytes, header);
}

DepthImage read_depth(const fs::path& file, ImageSize size, float depth_scale) {
    return to_metres(read_raw_depth(file, size), depth_scale);
}

RawDepth read_raw_depth(const fs::path& file, ImageSize size, float float_metre) {
    return decode_raw_depth(read_bytes(file), file.string(), size, float_metre);
}

Image<float> read_float_depth(const fs::path& file, ImageSize size) {
    const ByteBuffer bytes = read_bytes(file);
    const ImageHeader header = read_image_header(bytes, file);
    if (!header.is_float || header.bits != 32 || header.channels != 1) fail(file, "is no float depth image");
    expect_size(file, header.size, size);
    return decode_float(bytes, file.string(), header);
}

RawDepth quantised(const Image<float>& depth, float metre) {
    constexpr float kMost = 65534.0f;  // 65535 means saturated
    const float units = kFloatDepthScale / metre;
    RawDepth raw(depth.width(), depth.height());
    for (std::size_t i = 0; i < depth.size(); ++i) {
        const float value = std::round(depth[i] * units);
        if (value > 0 && value <= kMost) raw[i] = static_cast<std::uint16_t>(value);  // not NaN, not infinite
    }
    return raw;
}

DepthImage to_metres(const RawDepth& raw, float depth_scale) {
    constexpr std::uint16_t kSaturated = 65535;
    const float metres = 1.0f / depth_scale;
    DepthImage depth(raw.width(), raw.height());
    for (std::size_t i = 0; i < raw.size(); ++i)
        depth[i] = raw[i] == kSaturated ? 0.0f : static_cast<float>(raw[i]) * metres;
    return depth;
}

LabelImage read_labels(const fs::path& file, ImageSize size) {
    const ByteBuffer bytes = read_bytes(file);
    const ImageHeader header = read_image_header(bytes, file);
    if (header.format != ImageFormat::Png || header.bits > 8 || header.channels != 1)
        fail(file, "mask is not an 8-bit grey PNG");
    expect_size(file, header.size, size);
    const cv::Mat raw = decode(file, bytes, size, cv::IMREAD_UNCHANGED);
    if (raw.type() != CV_8UC1) fail(file, "mask is not an 8-bit grey PNG");
    return pixels_of<std::uint8_t>(raw);
}

Image<std::uint16_t> read_wide_labels(const fs::path& file, ImageSize size) {
    const ByteBuffer bytes = read_bytes(file);
    const ImageHeader header = read_image_header(bytes, file);
    if (header.format != ImageFormat::Png || header.channels != 1) fail(file, "mask is not a grey PNG of 8 or 16 bit");
    expect_size(file, header.size, size);
    cv::Mat raw = decode(file, bytes, size, cv::IMREAD_UNCHANGED);
    if (raw.channels() != 1) fail(file, "mask is not a grey PNG of 8 or 16 bit");
    raw.convertTo(raw, CV_16UC1);
    return pixels_of<std::uint16_t>(raw);
}

ImageSize image_size(ByteView bytes, const std::string& name) { return read_image_header(bytes, name).size; }

ColorImage decode_color(ByteView bytes, const std::string& name, ImageSize size) {
    const ImageHeader header = read_image_header(bytes, name);
    expect_size(name, header.size, size);
    return decode_color(name, bytes, header);
}

RawDepth decode_raw_depth(ByteView bytes, const std::string& name, ImageSize size, float float_metre) {
    const ImageHeader header = read_image_header(bytes, name);
    if (header.channels != 1)
        fail(name, std::string("is not a 16-bit grey image (is this a colour image?); ") + kDepthKinds);
    if (header.bits == 8)
        fail(name,
             std::string("is an 8-bit image: 256 steps are a picture of depth, not a measurement; ") + kDepthKinds);
    if (!(header.bits == 16 && !header.is_float) && !(header.bits == 32 && header.is_float))
        fail(name, "is a " + std::to_string(header.bits) + "-bit " + (header.is_float ? "float" : "integer") +
                       " image; " + kDepthKinds);
    expect_size(name, header.size, size);
    if (header.is_float) return quantised(decode_float(bytes, name, header), float_metre);
    if (header.format == ImageFormat::Pnm) return decode_pgm(bytes, name);
    if (header.format == ImageFormat::Tiff) return decode_tiff_short(bytes, name);
    const cv::Mat raw = decode(name, bytes, size, cv::IMREAD_UNCHANGED);
    if (raw.type() != CV_16UC1) fail(name, "image is damaged");
    return pixels_of<std::uint16_t>(raw);
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
    RawDepth raw(depth.width(), depth.height());
    for (std::size_t i = 0; i < depth.size(); ++i) {
        const float value = std::round(depth[i] * depth_scale);
        const bool fits = value >= 0 && value < 65535.0f;
        raw[i] = fits ? static_cast<std::uint16_t>(value) : std::uint16_t{0};
    }
    write_raw_depth(file, raw);
}

void write_raw_depth(const fs::path& file, const RawDepth& depth) {
    const cv::Mat image(depth.height(), depth.width(), CV_16UC1, const_cast<std::uint16_t*>(depth.data()));
    write_file_atomically(file, encode(".png", image));
}

}  // namespace posefusion
