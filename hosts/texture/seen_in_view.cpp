#include "hosts/texture/seen_in_view.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "engine/core/pinhole.hpp"
#include "hosts/texture/triangle_raster.hpp"

namespace posefusion {
namespace {

constexpr float kNear = 0.1f;  // m; triangles that reach nearer to the camera do not hide anything
/// What is behind the mesh by this much is hidden: metres, and per metre of distance. The mesh is that far from the
/// true surface, and the pose from the true one.
constexpr float kHidden = 0.015f, kHiddenPerMetre = 0.01f;
/// A depth image that differs by more shows something else: metres, and per square metre of distance (noise of depth by
/// triangulation grows with the square).
constexpr float kOther = 0.04f, kOtherPerSquareMetre = 0.01f;
constexpr float kFlattest = 0.15f;  // cosine between surface and ray: 81 degrees
constexpr float kBorder = 0.1f;     // of the width: where the quality falls off

/// z along the optical axis of the nearest triangle; 0 = none.
DepthImage depth_of(const Mesh& mesh, const Eigen::Isometry3f& T_camera_world, const Intrinsics& camera) {
    std::vector<Eigen::Vector3f> seen;  // u, v, 1 / z; z <= 0: too near
    seen.reserve(mesh.vertices.size());
    for (const MeshVertex& vertex : mesh.vertices) {
        const Eigen::Vector3f p = T_camera_world * vertex.position;
        const Eigen::Vector2f pixel = p.z() > kNear ? project(p, camera) : Eigen::Vector2f::Zero();
        seen.emplace_back(pixel.x(), pixel.y(), p.z() > kNear ? 1 / p.z() : 0);
    }
    Image<float> inverse(camera.width, camera.height);
    for (const auto& face : mesh.faces) {
        const Eigen::Vector3f &a = seen[face[0]], &b = seen[face[1]], &c = seen[face[2]];
        if (a.z() == 0 || b.z() == 0 || c.z() == 0) continue;
        rasterise({a.head<2>(), b.head<2>(), c.head<2>()}, camera.width, camera.height,
                  [&](int u, int v, const Eigen::Vector3f& w) {
                      inverse(u, v) = std::max(inverse(u, v), w.dot(Eigen::Vector3f(a.z(), b.z(), c.z())));
                  });
    }
    for (float& value : inverse) value = value > 0 ? 1 / value : 0;
    return inverse;
}

/// The least of what is there in the 3 x 3 pixels: colours of the foreground reach a pixel over its edge.
DepthImage nearest_around(const DepthImage& depth) {
    DepthImage nearest(depth.width(), depth.height());
    for (int v = 0; v < depth.height(); ++v) {
        for (int u = 0; u < depth.width(); ++u) {
            float& least = nearest(u, v);
            for (int y = std::max(v - 1, 0); y <= std::min(v + 1, depth.height() - 1); ++y)
                for (int x = std::max(u - 1, 0); x <= std::min(u + 1, depth.width() - 1); ++x)
                    if (const float z = depth(x, y); z > 0 && (least == 0 || z < least)) least = z;
        }
    }
    return nearest;
}

}  // namespace

SeenInView::SeenInView(const Mesh& mesh, const View& view, const Intrinsics& camera)
    : view_(view),
      camera_(camera),
      T_camera_world_(view.T_world_camera.inverse().cast<float>()),
      nearest_(nearest_around(depth_of(mesh, T_camera_world_, camera))) {}

std::optional<Eigen::Vector2f> SeenInView::pixel_of(const Eigen::Vector3f& point) const {
    const Eigen::Vector3f p = T_camera_world_ * point;
    if (!(p.z() > kNear)) return std::nullopt;
    const Eigen::Vector2f pixel = project(p, camera_);
    if (!in_image(pixel, camera_)) return std::nullopt;
    const int u = static_cast<int>(std::lround(pixel.x())), v = static_cast<int>(std::lround(pixel.y()));
    const float nearest = nearest_(u, v);
    if (nearest > 0 && p.z() > nearest + kHidden + kHiddenPerMetre * p.z()) return std::nullopt;
    if (!view_.people.empty() && view_.people(u, v) != 0) return std::nullopt;
    const float measured = view_.depth.empty() ? 0 : view_.depth(u, v);
    if (measured > 0 && std::abs(measured - p.z()) > kOther + kOtherPerSquareMetre * p.z() * p.z()) return std::nullopt;
    return pixel;
}

float SeenInView::quality(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const {
    const auto pixel = pixel_of(point);
    if (!pixel) return 0;
    const Eigen::Vector3f p = T_camera_world_ * point;
    const float cosine = -(T_camera_world_.linear() * normal).dot(p.normalized());
    if (cosine < kFlattest) return 0;
    const float to_border = std::min({pixel->x(), pixel->y(), static_cast<float>(camera_.width - 1) - pixel->x(),
                                      static_cast<float>(camera_.height - 1) - pixel->y()});
    const float falloff = std::min(1.0f, (to_border + 1) / (kBorder * static_cast<float>(camera_.width)));
    return falloff * cosine * camera_.fx * camera_.fy / (p.z() * p.z());
}

Eigen::Vector3f SeenInView::color_at(const Eigen::Vector2f& pixel) const {
    const ColorImage& image = view_.color;
    const int u = std::min(static_cast<int>(pixel.x()), image.width() - 2);
    const int v = std::min(static_cast<int>(pixel.y()), image.height() - 2);
    const float s = pixel.x() - static_cast<float>(u), t = pixel.y() - static_cast<float>(v);
    const auto at = [&](int x, int y) {
        const Rgb8 c = image(x, y);
        return Eigen::Vector3f(c.r, c.g, c.b);
    };
    return (1 - t) * ((1 - s) * at(u, v) + s * at(u + 1, v)) + t * ((1 - s) * at(u, v + 1) + s * at(u + 1, v + 1));
}

}  // namespace posefusion
