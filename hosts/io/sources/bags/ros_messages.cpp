#include "hosts/io/sources/bags/ros_messages.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "engine/core/error.hpp"
#include "hosts/io/image_header.hpp"
#include "hosts/io/rvl.hpp"

namespace posefusion {
namespace {

constexpr float kMillimetres = 1000.0f;  ///< 16-bit depth, REP 118

struct Picture {
    std::string frame_id;
    ImageSize size;
    std::string encoding;
    bool big_endian = false;
    std::size_t step = 0;  ///< bytes of a row
    ByteView data;
};

Picture parse_image(const RosMessage& message, const std::string& name) {
    RosReader reader(message, name);
    Picture picture;
    picture.frame_id = reader.take_header();
    const auto height = reader.take<std::uint32_t>(), width = reader.take<std::uint32_t>();
    if (height == 0 || width == 0 || height > kMaxImageSide || width > kMaxImageSide)
        throw Error(name + ": has an impossible size, " + std::to_string(width) + "x" + std::to_string(height));
    picture.size = {static_cast<int>(width), static_cast<int>(height)};
    picture.encoding = reader.take_text();
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
    throw Error(name + ": image is " + size_text(found) + ", expected " + size_text(expected) + " as the camera says");
}

struct Packed {
    std::string frame_id;
    std::string format;
    ByteView data;
};

Packed parse_compressed(const RosMessage& message, const std::string& name) {
    RosReader reader(message, name);
    Packed packed;
    packed.frame_id = reader.take_header();
    packed.format = reader.take_text();
    packed.data = reader.take_block();
    return packed;
}

bool contains(const std::string& text, const char* part) { return text.find(part) != std::string::npos; }

/// The header that compressed_depth_image_transport puts before the image.
struct DepthPacking {
    bool is_float = false;  ///< the image holds A / depth + B, rounded
    float A = 0, B = 0;
    bool rvl = false;
    ByteView data;
};

bool is_compressed_depth(const Packed& packed) { return contains(packed.format, "compressedDepth"); }

DepthPacking parse_depth_packing(const Packed& packed, const std::string& name) {
    DepthPacking depth;
    depth.data = packed.data;
    if (!is_compressed_depth(packed)) return depth;
    ByteReader reader(packed.data, name);
    (void)reader.take<std::int32_t>();  // the kind of quantisation: there is only one
    depth.A = reader.take<float>();
    depth.B = reader.take<float>();
    depth.is_float = contains(packed.format, "32FC1");
    depth.rvl = contains(packed.format, "rvl");
    depth.data = reader.take(reader.left());
    return depth;
}

/// An RVL stream with the size before it.
struct SizedRvl {
    ImageSize size;
    ByteView data;
};

SizedRvl parse_rvl(ByteView bytes, const std::string& name) {
    ByteReader reader(bytes, name);
    const auto width = reader.take<std::uint32_t>(), height = reader.take<std::uint32_t>();
    if (height == 0 || width == 0 || height > kMaxImageSide || width > kMaxImageSide)
        throw Error(name + ": has an impossible size, " + std::to_string(width) + "x" + std::to_string(height));
    return {{static_cast<int>(width), static_cast<int>(height)}, reader.take(reader.left())};
}

RawDepth compressed_depth(const Packed& packed, const std::string& name, ImageSize size) {
    const DepthPacking packing = parse_depth_packing(packed, name);
    RawDepth raw;
    if (packing.rvl) {
        const SizedRvl rvl = parse_rvl(packing.data, name);
        check_size(rvl.size, size, name);
        raw = decode_rvl(rvl.data, size, name);
    } else {
        raw = decode_raw_depth(packing.data, name, size);
    }
    if (!packing.is_float) return raw;
    DepthImage metres(size.width, size.height);
    for (std::size_t i = 0; i < raw.size(); ++i)
        if (raw[i] != 0) metres[i] = packing.A / (static_cast<float>(raw[i]) - packing.B);
    return quantised(metres, 1);
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
                               {"rgba8", 4, 0, 1, 2}, {"bgra8", 4, 2, 1, 0}, {"8UC4", 4, 2, 1, 0},
                               {"mono8", 1, 0, 0, 0}, {"8UC1", 1, 0, 0, 0}};

/// Conversions by OpenCV.
struct Conversion {
    const char* encoding;
    std::size_t pixel_bytes;
    int code;
};
/// ROS names the first two pixels of the first two rows, OpenCV those of the second two.
constexpr Conversion kConversions[] = {
    {"bayer_rggb8", 1, cv::COLOR_BayerBG2RGB}, {"bayer_bggr8", 1, cv::COLOR_BayerRG2RGB},
    {"bayer_gbrg8", 1, cv::COLOR_BayerGR2RGB}, {"bayer_grbg8", 1, cv::COLOR_BayerGB2RGB},
    {"yuv422", 2, cv::COLOR_YUV2RGB_UYVY},     {"UYVY", 2, cv::COLOR_YUV2RGB_UYVY},
    {"uyvy", 2, cv::COLOR_YUV2RGB_UYVY},       {"yuv422_yuy2", 2, cv::COLOR_YUV2RGB_YUY2},
    {"YUYV", 2, cv::COLOR_YUV2RGB_YUY2},       {"yuyv", 2, cv::COLOR_YUV2RGB_YUY2}};

template <class Table>
auto find_encoding(const Table& table, const std::string& encoding) {
    return std::find_if(std::begin(table), std::end(table),
                        [&](const auto& entry) { return encoding == entry.encoding; });
}

ColorImage convert(const Picture& picture, const Conversion& conversion, const std::string& name) {
    check_rows(picture, conversion.pixel_bytes, name);
    const cv::Mat from(picture.size.height, picture.size.width, CV_8UC(static_cast<int>(conversion.pixel_bytes)),
                       const_cast<std::uint8_t*>(picture.data.data()), picture.step);
    ColorImage color(picture.size.width, picture.size.height);
    cv::Mat to(color.height(), color.width(), CV_8UC3, color.data());
    try {
        cv::cvtColor(from, to, conversion.code);
    } catch (const cv::Exception&) {
        throw Error(name + ": an image of " + size_text(picture.size) + " pixels cannot be of encoding '" +
                    picture.encoding + "'");
    }
    return color;
}

bool is_float_depth(const std::string& encoding) { return encoding == "32FC1"; }
bool is_short_depth(const std::string& encoding) { return encoding == "16UC1" || encoding == "mono16"; }

Eigen::Isometry3d take_transform(RosReader& reader, const std::string& name) {
    Eigen::Vector3d t;
    for (double& value : t) value = reader.take<double>();
    Eigen::Quaterniond q;
    for (const int i : {0, 1, 2, 3}) q.coeffs()[i] = reader.take<double>();  // x y z w in both
    const double norm = q.norm();
    if (!t.allFinite() || !(std::abs(norm - 1) < 1e-2)) throw Error(name + ": is damaged: no rigid motion");
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = q.normalized().toRotationMatrix();
    T.translation() = t;
    return T;
}

}  // namespace

Stamp ros_stamp(const RosMessage& message, const std::string& name) {
    RosReader reader(message, name);
    return reader.take_stamp();
}

RosImageKind ros_image_kind(const RosMessage& message, bool compressed, const std::string& name) {
    if (!compressed) {
        Picture picture = parse_image(message, name);
        return {std::move(picture.frame_id), std::move(picture.encoding), picture.size};
    }
    const Packed packed = parse_compressed(message, name);
    RosImageKind kind;
    kind.frame_id = packed.frame_id;
    const std::size_t end = packed.format.find(';');
    if (end != std::string::npos) kind.encoding = packed.format.substr(0, end);
    const DepthPacking packing = parse_depth_packing(packed, name);
    if (packing.rvl) {
        kind.size = parse_rvl(packing.data, name).size;
    } else {
        const ImageHeader header = read_image_header(packing.data, name);
        kind.size = header.size;
        const bool is_short = header.bits == 16 && header.channels == 1;
        if (kind.encoding.empty() || is_short != (is_depth_encoding(kind.encoding) || kind.encoding == "mono16"))
            kind.encoding = is_short ? "16UC1" : header.channels == 1 ? "mono8" : "rgb8";
    }
    return kind;
}

bool is_depth_encoding(const std::string& encoding) { return is_float_depth(encoding) || encoding == "16UC1"; }

bool is_grey_encoding(const std::string& encoding) { return encoding == "mono8" || encoding == "8UC1"; }

bool is_color_encoding(const std::string& encoding) {
    return find_encoding(kLayouts, encoding) != std::end(kLayouts) ||
           find_encoding(kConversions, encoding) != std::end(kConversions);
}

ColorImage ros_color(const RosMessage& message, bool compressed, const std::string& name, ImageSize size) {
    if (compressed) return decode_color(parse_compressed(message, name).data, name, size);
    const Picture picture = parse_image(message, name);
    check_size(picture.size, size, name);
    const auto conversion = find_encoding(kConversions, picture.encoding);
    if (conversion != std::end(kConversions)) return convert(picture, *conversion, name);
    const auto layout = find_encoding(kLayouts, picture.encoding);
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

RawDepth ros_depth(const RosMessage& message, bool compressed, const std::string& name, ImageSize size) {
    if (compressed) return compressed_depth(parse_compressed(message, name), name, size);
    const Picture picture = parse_image(message, name);
    check_size(picture.size, size, name);
    const bool is_float = is_float_depth(picture.encoding);
    if (is_grey_encoding(picture.encoding))
        throw Error(name + ": depth images of 8 bits ('" + picture.encoding +
                    "') are pictures of depth, not measurements; record 16UC1 or 32FC1");
    if (!is_float && !is_short_depth(picture.encoding))
        throw Error(name + ": depth images of encoding '" + picture.encoding + "' cannot be read; give 16UC1 or 32FC1");
    check_rows(picture, is_float ? sizeof(float) : sizeof(std::uint16_t), name);
    const auto pixels = [&]<class Value>(Image<Value> image) {
        for (int v = 0; v < size.height; ++v) {
            const std::uint8_t* pixel = picture.data.data() + static_cast<std::size_t>(v) * picture.step;
            for (int u = 0; u < size.width; ++u, pixel += sizeof(Value))
                image(u, v) = load<Value>(pixel, picture.big_endian);
        }
        return image;
    };
    if (is_float) return quantised(pixels(DepthImage(size.width, size.height)), 1);
    return pixels(RawDepth(size.width, size.height));
}

RosCamera ros_camera(const RosMessage& camera_info, bool rectified, const std::string& name) {
    RosReader reader(camera_info, name);
    RosCamera result;
    result.frame_id = reader.take_header();
    const auto height = reader.take<std::uint32_t>(), width = reader.take<std::uint32_t>();
    const std::string model = reader.take_text();
    const auto coefficients = reader.take<std::uint32_t>();
    if (coefficients > reader.left() / sizeof(double)) throw Error(name + ": is damaged");
    std::vector<double> distortion(coefficients);
    for (double& d : distortion) d = reader.take<double>();
    const auto take_matrix = [&]<std::size_t Size>(std::array<double, Size> matrix) {
        for (double& m : matrix) m = reader.take<double>();
        return matrix;
    };
    const auto K = take_matrix(std::array<double, 9>{});
    (void)take_matrix(std::array<double, 9>{});  // R
    const auto P = take_matrix(std::array<double, 12>{});
    // P is 3x4, and zero without a calibrated stereo pair or rectified images
    const bool by_projection = rectified && P[0] > 0 && P[5] > 0;
    const std::array<double, 4> values =
        by_projection ? std::array<double, 4>{P[0], P[5], P[2], P[6]} : std::array<double, 4>{K[0], K[4], K[2], K[5]};
    constexpr double kMostPixels = 1e6;
    const bool sane = std::all_of(values.begin(), values.end(), [](double v) { return std::abs(v) < kMostPixels; });
    if (width == 0 || height == 0 || width > kMaxImageSide || height > kMaxImageSide || !sane || !(values[0] > 0) ||
        !(values[1] > 0))
        throw Error(name + ": the camera was not calibrated; give its values with --camera FILE");
    result.camera = {{static_cast<float>(values[0]), static_cast<float>(values[1]), static_cast<float>(values[2]),
                      static_cast<float>(values[3]), static_cast<int>(width), static_cast<int>(height)},
                     kMillimetres,
                     {}};
    const bool distorted =
        !rectified && std::any_of(distortion.begin(), distortion.end(), [](double d) { return d != 0; });
    if (!distorted) return result;
    if (is_wide_angle_model(model)) throw Error(name + ": the lens model is '" + model + "'; " + kWideAngleAdvice);
    LensCoefficients& lens = result.camera.distortion;
    const std::size_t most = model == "plumb_bob" ? 5 : model == "rational_polynomial" ? lens.size() : 0;
    if (distortion.size() > most) {
        result.warning = name + ": lens distortion of kind '" + model + "' with " + std::to_string(distortion.size()) +
                         " coefficients is not known and not undone; --camera FILE may say the nearest k1 k2 p1 p2 k3";
        return result;
    }
    for (std::size_t i = 0; i < distortion.size(); ++i) {
        if (!std::isfinite(distortion[i])) throw Error(name + ": is damaged: the distortion is not a number");
        lens[i] = static_cast<float>(distortion[i]);
    }
    return result;
}

Eigen::Isometry3d ros_transform(const RosMessage& message, const std::string& name) {
    RosReader reader(message, name);
    return take_transform(reader, name);
}

std::vector<RosTransform> ros_transforms(const RosMessage& message, const std::string& name) {
    RosReader reader(message, name);
    std::vector<RosTransform> all;
    for (auto count = reader.take<std::uint32_t>(); count > 0; --count) {
        RosTransform transform;
        transform.parent = reader.take_header();
        transform.child = reader.take_text();
        if (transform.child.starts_with('/')) transform.child.erase(0, 1);
        transform.T_parent_child = take_transform(reader, name);
        all.push_back(std::move(transform));
    }
    return all;
}

float ros_float(const RosMessage& message, const std::string& name) {
    RosReader reader(message, name);
    return reader.take<float>();
}

}  // namespace posefusion
