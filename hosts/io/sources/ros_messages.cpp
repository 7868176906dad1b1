#include "hosts/io/sources/ros_messages.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr float kMillimetres = 1000.0f;  ///< 16-bit depth, REP 118
constexpr float kFloatDepthScale = 5000.0f;
constexpr std::uint32_t kMaxSide = 8192;
constexpr std::uint32_t kNanosecondsPerMicrosecond = 1000;
/// compressed_depth_image_transport puts this before the PNG: format (int32) and quantisation (2 floats).
constexpr std::size_t kDepthPrefixBytes = 12;

void skip_header(ByteReader& reader) {
    (void)reader.take(kStampedBytes);  // sequence number and stamp
    (void)reader.take_block();         // frame id
}

struct Picture {
    ImageSize size;
    std::string encoding;
    bool big_endian = false;
    std::size_t step = 0;  ///< bytes of a row
    ByteView data;
};

Picture parse_image(const ByteBuffer& message, const std::string& name) {
    ByteReader reader(message, name);
    skip_header(reader);
    Picture picture;
    const auto height = reader.take<std::uint32_t>(), width = reader.take<std::uint32_t>();
    if (height == 0 || width == 0 || height > kMaxSide || width > kMaxSide)
        throw Error(name + ": has an impossible size, " + std::to_string(width) + "x" + std::to_string(height));
    picture.size = {static_cast<int>(width), static_cast<int>(height)};
    picture.encoding = reader.take_text().substr(0, 32);
    picture.big_endian = reader.take<std::uint8_t>() != 0;
    picture.step = reader.take<std::uint32_t>();
    picture.data = reader.take_block();
    return picture;
}

/// Rows of `pixel_bytes` bytes a pixel.
void check_rows(const Picture& picture, std::size_t pixel_bytes, const std::string& name) {
    const auto width = static_cast<std::size_t>(picture.size.width),
               height = static_cast<std::size_t>(picture.size.height);
    if (picture.step < width * pixel_bytes || picture.data.size() / height < picture.step)
        throw Error(name + ": is damaged: it has less data than pixels");
}

void check_size(ImageSize found, ImageSize expected, const std::string& name) {
    if (found == expected) return;
    throw Error(name + ": image is " + std::to_string(found.width) + "x" + std::to_string(found.height) +
                ", expected " + std::to_string(expected.width) + "x" + std::to_string(expected.height) +
                " as the camera says");
}

struct Packed {
    std::string format;
    ByteView data;
};

Packed parse_compressed(const ByteBuffer& message, const std::string& name) {
    ByteReader reader(message, name);
    skip_header(reader);
    std::string format = reader.take_text().substr(0, 64);
    return {std::move(format), reader.take_block()};
}

bool is_compressed_depth(const Packed& packed) { return packed.format.find("compressedDepth") != std::string::npos; }

ByteView depth_png(const Packed& packed, const std::string& name) {
    if (!is_compressed_depth(packed)) return packed.data;
    if (packed.format.find("32FC1") != std::string::npos)
        throw Error(name + ": compressed float depth cannot be read; record the topic uncompressed or as 16UC1");
    if (packed.data.size() < kDepthPrefixBytes) throw Error(name + ": is damaged: it is empty");
    return packed.data.subspan(kDepthPrefixBytes);
}

template <class Value>
Value load(const std::uint8_t* from, bool big_endian) {
    std::uint8_t bytes[sizeof(Value)];
    std::copy_n(from, sizeof(Value), bytes);
    if (big_endian) std::reverse(std::begin(bytes), std::end(bytes));
    Value value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
}

struct Layout {
    const char* encoding;
    std::size_t pixel_bytes, red, green, blue;
};
constexpr Layout kLayouts[] = {{"rgb8", 3, 0, 1, 2},  {"bgr8", 3, 2, 1, 0},  {"8UC3", 3, 2, 1, 0},
                               {"rgba8", 4, 0, 1, 2}, {"bgra8", 4, 2, 1, 0}, {"mono8", 1, 0, 0, 0},
                               {"8UC1", 1, 0, 0, 0}};

bool is_float_depth(const std::string& encoding) { return encoding == "32FC1"; }
bool is_short_depth(const std::string& encoding) { return encoding == "16UC1" || encoding == "mono16"; }

}  // namespace

double RosStamp::value() const {
    // By way of the text: the same double as a list file with the same digits gives.
    return std::strtod(text().c_str(), nullptr);
}

std::string RosStamp::text() const {
    char text[32];
    if (nanoseconds % kNanosecondsPerMicrosecond == 0)
        std::snprintf(text, sizeof text, "%u.%06u", seconds, nanoseconds / kNanosecondsPerMicrosecond);
    else
        std::snprintf(text, sizeof text, "%u.%09u", seconds, nanoseconds);
    return text;
}

RosStamp ros_stamp(const ByteBuffer& message, const std::string& name) {
    ByteReader reader(message, name);
    (void)reader.take<std::uint32_t>();  // sequence number
    RosStamp stamp;
    stamp.seconds = reader.take<std::uint32_t>();
    stamp.nanoseconds = reader.take<std::uint32_t>();
    return stamp;
}

ColorImage ros_color(const ByteBuffer& message, bool compressed, const std::string& name, ImageSize size) {
    if (compressed) return decode_color(parse_compressed(message, name).data, name, size);
    const Picture picture = parse_image(message, name);
    check_size(picture.size, size, name);
    const auto layout = std::find_if(std::begin(kLayouts), std::end(kLayouts),
                                     [&](const Layout& l) { return picture.encoding == l.encoding; });
    if (layout == std::end(kLayouts))
        throw Error(name + ": colour images of encoding '" + picture.encoding + "' cannot be read; give rgb8 or bgr8");
    check_rows(picture, layout->pixel_bytes, name);
    ColorImage color(size.width, size.height);
    for (int v = 0; v < size.height; ++v) {
        const std::uint8_t* pixel = picture.data.data() + static_cast<std::size_t>(v) * picture.step;
        for (int u = 0; u < size.width; ++u, pixel += layout->pixel_bytes)
            color(u, v) = {pixel[layout->red], pixel[layout->green], pixel[layout->blue]};
    }
    return color;
}

RawDepth ros_depth(const ByteBuffer& message, bool compressed, const std::string& name, ImageSize size) {
    if (compressed) {
        const Packed packed = parse_compressed(message, name);
        return decode_raw_depth(depth_png(packed, name), name, size);
    }
    const Picture picture = parse_image(message, name);
    check_size(picture.size, size, name);
    const bool is_float = is_float_depth(picture.encoding);
    if (!is_float && !is_short_depth(picture.encoding))
        throw Error(name + ": depth images of encoding '" + picture.encoding + "' cannot be read; give 16UC1 or 32FC1");
    const std::size_t pixel_bytes = is_float ? sizeof(float) : sizeof(std::uint16_t);
    check_rows(picture, pixel_bytes, name);
    constexpr float kMost = 65534.0f;  // 65535 means saturated
    RawDepth depth(size.width, size.height);
    for (int v = 0; v < size.height; ++v) {
        const std::uint8_t* pixel = picture.data.data() + static_cast<std::size_t>(v) * picture.step;
        for (int u = 0; u < size.width; ++u, pixel += pixel_bytes) {
            if (!is_float) {
                depth(u, v) = load<std::uint16_t>(pixel, picture.big_endian);
                continue;
            }
            const float units = std::round(load<float>(pixel, picture.big_endian) * kFloatDepthScale);
            if (units > 0 && units <= kMost) depth(u, v) = static_cast<std::uint16_t>(units);  // NaN: no measurement
        }
    }
    return depth;
}

float ros_depth_scale(const ByteBuffer& message, bool compressed, const std::string& name) {
    return !compressed && is_float_depth(parse_image(message, name).encoding) ? kFloatDepthScale : kMillimetres;
}

ImageSize ros_image_size(const ByteBuffer& message, bool compressed, const std::string& name) {
    return compressed ? image_size(parse_compressed(message, name).data, name) : parse_image(message, name).size;
}

Camera ros_camera(const ByteBuffer& camera_info, bool rectified, const std::string& name, std::string& warning) {
    ByteReader reader(camera_info, name);
    skip_header(reader);
    const auto height = reader.take<std::uint32_t>(), width = reader.take<std::uint32_t>();
    const std::string model = reader.take_text().substr(0, 32);
    const auto coefficients = reader.take<std::uint32_t>();
    if (coefficients > reader.left() / sizeof(double)) throw Error(name + ": is damaged");
    std::vector<double> distortion(coefficients);
    for (double& d : distortion) d = reader.take<double>();
    double K[9];
    for (double& k : K) k = reader.take<double>();
    double largest = 0;
    for (const double k : K) largest = std::isfinite(k) ? std::max(largest, std::abs(k)) : INFINITY;
    constexpr double kMostPixels = 1e6;
    if (width == 0 || height == 0 || width > kMaxSide || height > kMaxSide || !(K[0] > 0) || !(K[4] > 0) ||
        !(largest < kMostPixels))
        throw Error(name + ": the camera was not calibrated; give its values with --camera FILE");
    Camera camera{{static_cast<float>(K[0]), static_cast<float>(K[4]), static_cast<float>(K[2]),
                   static_cast<float>(K[5]), static_cast<int>(width), static_cast<int>(height)},
                  kMillimetres,
                  {}};
    const bool distorted =
        !rectified && std::any_of(distortion.begin(), distortion.end(), [](double d) { return d != 0; });
    if (!distorted) return camera;
    if (model != "plumb_bob" || distortion.size() > camera.distortion.size()) {
        warning = name + ": lens distortion of kind '" + model + "' is not known and not undone";
        return camera;
    }
    for (std::size_t i = 0; i < distortion.size(); ++i) {
        if (!std::isfinite(distortion[i])) throw Error(name + ": is damaged: the distortion is not a number");
        camera.distortion[i] = static_cast<float>(distortion[i]);
    }
    return camera;
}

}  // namespace posefusion
