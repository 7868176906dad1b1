#include "hosts/io/image_geometry.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "engine/core/pinhole.hpp"
#include "hosts/io/lens.hpp"

namespace posefusion {
namespace {

using Eigen::Vector2f;

/// The engine's pyramid halves the image twice.
constexpr int kSizeMultiple = 4;
/// Measurements of one surface differ less than this within a block, relative to depth: a floor seen at a grazing angle
/// changes by 1.5 % over four rows, quantisation by 1.4 % at 5 m.
constexpr float kSameBlockSurface = 0.02f;

/// Output pixel i covers the source pixels [begin(i), begin(i + 1)).
std::vector<int> block_begins(int source, int output) {
    std::vector<int> begins(static_cast<std::size_t>(output) + 1);
    for (int i = 0; i <= output; ++i)
        begins[static_cast<std::size_t>(i)] = static_cast<int>(static_cast<long long>(i) * source / output);
    return begins;
}

/// @param block  measurements, reordered
float mean_near_median(std::vector<float>& block) {
    const auto middle = block.begin() + static_cast<std::ptrdiff_t>((block.size() - 1) / 2);
    std::nth_element(block.begin(), middle, block.end());
    const float median = *middle;
    float sum = 0;
    int count = 0;
    for (const float d : block) {
        if (std::abs(d - median) > kSameBlockSurface * median) continue;
        sum += d;
        ++count;
    }
    return sum / static_cast<float>(count);
}

template <class Pixel>
constexpr int kMatType = 0;
template <>
constexpr int kMatType<Rgb8> = CV_8UC3;
template <>
constexpr int kMatType<float> = CV_32FC1;
template <>
constexpr int kMatType<std::uint8_t> = CV_8UC1;
template <>
constexpr int kMatType<PixelPosition> = CV_32FC2;

template <class Pixel>
cv::Mat view(const Image<Pixel>& image) {
    return {image.height(), image.width(), kMatType<Pixel>, const_cast<Pixel*>(image.data())};
}

/// Colour is interpolated and repeats its border; depth and labels do neither.
template <class Pixel>
Image<Pixel> look_up(const Image<Pixel>& image, const LensMap& positions) {
    constexpr bool kColor = kMatType<Pixel> == CV_8UC3;
    Image<Pixel> result(positions.width(), positions.height());
    cv::Mat to = view(result);
    cv::remap(view(image), to, view(positions), cv::Mat(), kColor ? cv::INTER_LINEAR : cv::INTER_NEAREST,
              kColor ? cv::BORDER_REPLICATE : cv::BORDER_CONSTANT, cv::Scalar());
    return result;
}

/// Positions far outside are treated like those just outside; NaN is outside as well.
float in_reach(float position, int size) {
    constexpr float kOutside = 2;  // pixels beyond the border: neither neighbour of such a position is in the image
    return position > -kOutside ? std::min(position, static_cast<float>(size) - 1 + kOutside) : -kOutside;
}

template <class Function>
LensMap lens_map(const Intrinsics& K, Function move) {
    LensMap map(K.width, K.height);
    for (int v = 0; v < K.height; ++v) {
        for (int u = 0; u < K.width; ++u) {
            const Eigen::Vector3f ray = pixel_ray(static_cast<float>(u), static_cast<float>(v), K);
            const PlanePoint p = move(PlanePoint{ray.x(), ray.y()});
            const Eigen::Vector2f at = project(Eigen::Vector3f(p.x, p.y, 1), K);
            map(u, v) = {in_reach(at.x(), K.width), in_reach(at.y(), K.height)};
        }
    }
    return map;
}

int shrunk_size(int size, float scale) {
    constexpr float kRounding = 1e-3f;  // pixels: 640 * 0.7f is 447.99998
    return static_cast<int>(static_cast<float>(size) * scale + kRounding) / kSizeMultiple * kSizeMultiple;
}

int used_size(int output, int source, float scale) {
    return std::min(source, static_cast<int>(std::lround(static_cast<float>(output) / scale)));
}

template <class Pixel>
void check_size(const Image<Pixel>& image, const Intrinsics& source) {
    if (image.width() != source.width || image.height() != source.height)
        throw Error("image is not of the size that the camera file says");
}

/// Source pixel that holds the centre of output pixel i.
int block_centre(int i, int used, int output) { return static_cast<int>((2LL * i + 1) * used / (2LL * output)); }

}  // namespace

ImageGeometry::ImageGeometry(const Camera& camera, float scale) : source_(camera.intrinsics) {
    if (!(scale > 0) || scale > 1) throw Error("scale must be above 0 and at most 1, not " + shortest_text(scale));
    const Intrinsics& K = source_;
    const int width = shrunk_size(K.width, scale), height = shrunk_size(K.height, scale);
    if (width == 0 || height == 0)
        throw Error("images of " + std::to_string(K.width) + "x" + std::to_string(K.height) + " pixels at scale " +
                    shortest_text(scale) + " leave less than 4x4 pixels");
    used_width_ = used_size(width, K.width, scale);
    used_height_ = used_size(height, K.height, scale);
    intrinsics_ = resized({K.fx, K.fy, K.cx, K.cy, used_width_, used_height_}, width, height);
    deformation_ = deformation_map(camera.deformation, K.width, K.height);
    if (!camera.distorted()) return;
    lens_ = lens_map(K, [&](PlanePoint p) { return distort(p, camera.distortion); });
    to_ideal_ = lens_map(K, [&](PlanePoint p) { return posefusion::undistort(p, camera.distortion); });
}

template <class Pixel>
Image<Pixel> ImageGeometry::undistort(Image<Pixel> image) const {
    check_size(image, source_);
    return lens_.empty() ? std::move(image) : look_up(image, lens_);
}

ImageGeometry::FrameImages ImageGeometry::from_source(ColorImage color, DepthImage depth) const {
    FrameImages images;
    if (!lens_.empty() && undistorter_) {
        check_size(color, source_);
        check_size(depth, source_);
        images.undistort = undistorter_(color, depth);
    } else {
        color = undistort(std::move(color));
        depth = undistort(std::move(depth));
    }
    undo_deformation(deformation_, depth);
    images.color = shrink(std::move(color));
    images.depth = shrink(std::move(depth));
    return images;
}

ColorImage ImageGeometry::from_source(ColorImage color) const { return shrink(undistort(std::move(color))); }

DepthImage ImageGeometry::from_source(DepthImage depth) const {
    depth = undistort(std::move(depth));
    undo_deformation(deformation_, depth);
    return shrink(std::move(depth));
}

ColorImage ImageGeometry::shrink(ColorImage color) const {
    if (intrinsics_.width == source_.width && intrinsics_.height == source_.height) return color;
    ColorImage result(intrinsics_.width, intrinsics_.height);
    cv::Mat to = view(result);
    cv::resize(view(color)(cv::Rect(0, 0, used_width_, used_height_)), to, to.size(), 0, 0, cv::INTER_AREA);
    return result;
}

DepthImage ImageGeometry::shrink(DepthImage depth) const {
    if (intrinsics_.width == source_.width && intrinsics_.height == source_.height) return depth;
    const std::vector<int> u_begin = block_begins(used_width_, intrinsics_.width);
    const std::vector<int> v_begin = block_begins(used_height_, intrinsics_.height);
    DepthImage result(intrinsics_.width, intrinsics_.height);
    std::vector<float> block;
    for (int v = 0; v < result.height(); ++v) {
        const int v0 = v_begin[static_cast<std::size_t>(v)], v1 = v_begin[static_cast<std::size_t>(v) + 1];
        for (int u = 0; u < result.width(); ++u) {
            const int u0 = u_begin[static_cast<std::size_t>(u)], u1 = u_begin[static_cast<std::size_t>(u) + 1];
            block.clear();
            for (int y = v0; y < v1; ++y)
                for (int x = u0; x < u1; ++x)
                    if (const float d = depth(x, y); d > 0) block.push_back(d);
            const auto pixels = static_cast<std::size_t>(v1 - v0) * static_cast<std::size_t>(u1 - u0);
            if (!block.empty() && 2 * block.size() >= pixels) result(u, v) = mean_near_median(block);
        }
    }
    return result;
}

LabelImage ImageGeometry::from_source(LabelImage labels) const {
    labels = undistort(std::move(labels));
    LabelImage result(intrinsics_.width, intrinsics_.height);
    for (int v = 0; v < result.height(); ++v)
        for (int u = 0; u < result.width(); ++u)
            result(u, v) =
                labels(block_centre(u, used_width_, result.width()), block_centre(v, used_height_, result.height()));
    return result;
}

LabelImage ImageGeometry::to_source(LabelImage labels) const {
    if (labels.width() != intrinsics_.width || labels.height() != intrinsics_.height)
        throw Error("label image is not of the size of the frames");
    LabelImage full(source_.width, source_.height);
    for (int v = 0; v < used_height_; ++v)
        for (int u = 0; u < used_width_; ++u)
            full(u, v) =
                labels(block_centre(u, labels.width(), used_width_), block_centre(v, labels.height(), used_height_));
    return to_ideal_.empty() ? full : look_up(full, to_ideal_);
}

}  // namespace posefusion
