#include "hosts/io/depth_registration.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "engine/core/error.hpp"
#include "engine/core/pinhole.hpp"

namespace posefusion {
namespace {

/// Neighbours of one surface differ less than this, relative to depth: a wall seen at 80 degrees from a depth camera of
/// 256 pixels (60 degrees) changes by 3 % from pixel to pixel, and quantisation at 5 m is 1.4 %.
constexpr float kSamePatchSurface = 0.05f;
/// Points nearer to the colour camera than this are wrong measurements. In metres.
constexpr float kNearest = 0.05f;
/// Pixel centres this little outside of a triangle belong to it: two triangles leave no crack. In areas of a pixel.
constexpr float kEdge = 1e-3f;
constexpr int kTrianglesAtPixel = 6;  ///< that meet at a measurement inside of a surface

/// A measurement in the colour image; z = 0: none.
struct Vertex {
    float u = 0, v = 0, z = 0;
};

bool same_surface(const Vertex& a, const Vertex& b, const Vertex& c) {
    const auto [least, most] = std::minmax({a.z, b.z, c.z});
    return least > 0 && most - least < kSamePatchSurface * least;
}

void keep_nearest(float& there, float z) {
    if (there == 0 || z < there) there = z;
}

struct PixelRange {
    int begin = 0, end = 0;
};

/// Pixels whose centres lie in [from, to], inside of the image.
PixelRange pixels_between(float from, float to, int size) {
    const float begin = std::clamp(std::ceil(from), 0.0f, static_cast<float>(size)),
                end = std::clamp(std::floor(to) + 1, 0.0f, static_cast<float>(size));
    return {static_cast<int>(begin), static_cast<int>(end)};
}

/// 1/z is linear in the image of a plane.
void draw_triangle(DepthImage& image, const Vertex& a, const Vertex& b, const Vertex& c) {
    const float area = (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
    if (area == 0) return;
    const float sign = area > 0 ? 1.0f : -1.0f, whole = std::abs(area);
    const auto side = [&](const Vertex& p, const Vertex& q, float u, float v) {
        return sign * ((q.u - p.u) * (v - p.v) - (q.v - p.v) * (u - p.u));
    };
    const auto [left, right] = std::minmax({a.u, b.u, c.u});
    const auto [top, bottom] = std::minmax({a.v, b.v, c.v});
    const PixelRange us = pixels_between(left - kEdge, right + kEdge, image.width()),
                     vs = pixels_between(top - kEdge, bottom + kEdge, image.height());
    for (int v = vs.begin; v < vs.end; ++v) {
        for (int u = us.begin; u < us.end; ++u) {
            const auto pu = static_cast<float>(u), pv = static_cast<float>(v);
            const float at_a = side(b, c, pu, pv), at_b = side(c, a, pu, pv), at_c = side(a, b, pu, pv);
            if (std::min({at_a, at_b, at_c}) < -kEdge) continue;
            keep_nearest(image(u, v), whole / (at_a / a.z + at_b / b.z + at_c / c.z));
        }
    }
}

/// Whether one image can be a scaled version of the other; sizes are whole pixels.
bool same_shape(ImageSize a, ImageSize b) {
    const auto differs = [](int shrunk, double exact) { return std::abs(shrunk - exact) > 1.0; };
    return a.width >= b.width ? !differs(b.height, static_cast<double>(a.height) * b.width / a.width)
                              : !differs(a.height, static_cast<double>(b.height) * a.width / b.width);
}

}  // namespace

DepthRegistration::DepthRegistration(const DepthCamera& depth, const Camera& color)
    : color_(color),
      T_color_depth_(depth.T_color_depth),
      rays_(depth.intrinsics.width, depth.intrinsics.height),
      footprint_u_(0.5f * color.intrinsics.fx / depth.intrinsics.fx),
      footprint_v_(0.5f * color.intrinsics.fy / depth.intrinsics.fy) {
    const Intrinsics& K = depth.intrinsics;
    for (int y = 0; y < K.height; ++y)
        for (int x = 0; x < K.width; ++x) {
            const Eigen::Vector3f ray = pixel_ray(static_cast<float>(x), static_cast<float>(y), K);
            rays_(x, y) = undistort({ray.x(), ray.y()}, depth.distortion);
        }
}

RawDepth DepthRegistration::apply(const RawDepth& raw, float depth_scale) const {
    const int width = rays_.width(), height = rays_.height();
    if (raw.width() != width || raw.height() != height) throw Error("depth image is not of the size of its camera");
    const Intrinsics& K = color_.intrinsics;
    const DepthImage depth = to_metres(raw, depth_scale);
    Image<Vertex> vertices(width, height);
    for (std::size_t i = 0; i < depth.size(); ++i) {
        if (!(depth[i] > 0)) continue;
        const Eigen::Vector3f p =
            T_color_depth_ * Eigen::Vector3f(rays_[i].x * depth[i], rays_[i].y * depth[i], depth[i]);
        if (!(p.z() > kNearest)) continue;
        const PlanePoint image = distort({p.x() / p.z(), p.y() / p.z()}, color_.distortion);
        const Eigen::Vector2f at = project(Eigen::Vector3f(image.x, image.y, 1), K);
        const Vertex vertex{at.x(), at.y(), p.z()};
        if (std::isfinite(vertex.u) && std::isfinite(vertex.v)) vertices[i] = vertex;
    }

    DepthImage registered(K.width, K.height);
    Image<std::uint8_t> triangles(width, height);  // that meet at a measurement
    const auto draw = [&](std::array<std::pair<int, int>, 3> corners) {
        const Vertex &a = vertices(corners[0].first, corners[0].second),
                     &b = vertices(corners[1].first, corners[1].second),
                     &c = vertices(corners[2].first, corners[2].second);
        if (!same_surface(a, b, c)) return;
        draw_triangle(registered, a, b, c);
        for (const auto& [x, y] : corners) ++triangles(x, y);
    };
    for (int y = 0; y + 1 < height; ++y) {
        for (int x = 0; x + 1 < width; ++x) {
            draw({{{x, y}, {x + 1, y}, {x, y + 1}}});
            draw({{{x + 1, y + 1}, {x, y + 1}, {x + 1, y}}});
        }
    }

    DepthImage edges(K.width, K.height);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const Vertex& vertex = vertices[i];
        if (vertex.z == 0 || triangles[i] == kTrianglesAtPixel) continue;
        const float nearer = depth[i] / vertex.z;  // a pixel covers a larger area in an image taken from nearby
        const PixelRange us = pixels_between(vertex.u - footprint_u_ * nearer, vertex.u + footprint_u_ * nearer,
                                             K.width),
                         vs = pixels_between(vertex.v - footprint_v_ * nearer, vertex.v + footprint_v_ * nearer,
                                             K.height);
        for (int v = vs.begin; v < vs.end; ++v)
            for (int u = us.begin; u < us.end; ++u) keep_nearest(edges(u, v), vertex.z);
    }

    constexpr float kMost = 65534.0f;  // 65535 means saturated
    RawDepth result(K.width, K.height);
    for (std::size_t i = 0; i < result.size(); ++i) {
        float z = registered[i];
        // Interpolation within a surface is more accurate than the footprint of a single measurement, unless something
        // hides it.
        if (edges[i] > 0 && (z == 0 || edges[i] < (1 - kSamePatchSurface) * z)) z = edges[i];
        const float value = std::round(z * depth_scale);
        if (value > 0 && value <= kMost) result[i] = static_cast<std::uint16_t>(value);
    }
    return result;
}

std::optional<DepthRegistration> registration_for(const CameraDescription& description, std::optional<ImageSize> depth,
                                                  const std::string& name, std::vector<std::string>& warnings) {
    const Intrinsics& K = description.camera.intrinsics;
    if (description.depth) {
        const ImageSize said{description.depth->intrinsics.width, description.depth->intrinsics.height};
        if (depth && !(*depth == said))
            throw Error(name + ": the depth images are " + size_text(*depth) +
                        ", but the camera says depth_width and depth_height " + size_text(said));
        return DepthRegistration(*description.depth, description.camera);
    }
    const ImageSize color{K.width, K.height};
    if (!depth || *depth == color) return std::nullopt;
    if (!same_shape(color, *depth))
        throw Error(name + ": depth images are " + size_text(*depth) + ", colour is " + size_text(color) +
                    ", and they are not of one camera; give depth_fx depth_fy depth_cx depth_cy depth_width "
                    "depth_height (and T_color_depth) in the camera file, so that depth can be registered");
    warnings.push_back(name + ": depth images are " + size_text(*depth) + ", colour is " + size_text(color) +
                       "; they are taken to be of one camera (otherwise give depth_fx depth_fy depth_cx depth_cy "
                       "depth_width depth_height and T_color_depth in the camera file)");
    return DepthRegistration(
        {resized(K, depth->width, depth->height), description.camera.distortion, Eigen::Isometry3f::Identity()},
        description.camera);
}

}  // namespace posefusion
