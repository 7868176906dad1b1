#include "hosts/synth/mesh_builder.hpp"

#include <algorithm>
#include <cmath>

#include "hosts/synth/random.hpp"

namespace posefusion::synth {
namespace {

constexpr float kFaceSize = 0.12f;  ///< longest edge of a face, metres: what baked light can resolve

int pieces(float length) { return std::max(1, static_cast<int>(std::ceil(length / kFaceSize - 0.01f))); }

}  // namespace

MeshBuilder MeshBuilder::at(const Vector3f& origin, float yaw) const {
    Eigen::Isometry3f frame = Eigen::Isometry3f::Identity();
    frame.linear() = Eigen::AngleAxisf(yaw, Vector3f::UnitZ()).toRotationMatrix();
    frame.translation() = origin;
    return at(frame);
}

std::uint32_t MeshBuilder::vertex(const Vector3f& position, const Vector3f& normal, const Vector2f& uv,
                                  const Vector3f& tint) const {
    mesh_.vertices.push_back({frame_ * position, frame_.linear() * normal, uv, tint});
    return static_cast<std::uint32_t>(mesh_.vertices.size() - 1);
}

void MeshBuilder::triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, Material material) const {
    mesh_.triangles.push_back({a, b, c});
    mesh_.material.push_back(material);
}

void MeshBuilder::quad(const Vector3f& corner, const Vector3f& right, const Vector3f& down, Material material,
                       const Vector3f& tint, const Vector2f& uv) const {
    const float width = right.norm(), height = down.norm();
    const int columns = pieces(width), rows = pieces(height);
    const Vector3f normal = down.cross(right).normalized();
    const bool along =
        (material == Wood || material == DarkWood) && width > height;  // the grain follows the longer edge
    const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
    for (int r = 0; r <= rows; ++r)
        for (int c = 0; c <= columns; ++c) {
            const float s = static_cast<float>(c) / static_cast<float>(columns),
                        t = static_cast<float>(r) / static_cast<float>(rows);
            const Vector2f here = along ? Vector2f(t * height, s * width) : Vector2f(s * width, t * height);
            vertex(corner + s * right + t * down, normal, uv + here, tint);
        }
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
            const auto a = first + static_cast<std::uint32_t>(r * (columns + 1) + c), b = a + 1;
            const auto d = a + static_cast<std::uint32_t>(columns + 1), e = d + 1;
            triangle(a, d, b, material);
            triangle(b, d, e, material);
        }
}

void MeshBuilder::box(const Vector3f& low, const Vector3f& high, Material material, const Vector3f& tint,
                      const Vector2f& uv) const {
    const Vector3f d = high - low;
    const Vector3f x(d.x(), 0, 0), y(0, d.y(), 0), z(0, 0, d.z());
    quad({high.x(), low.y(), high.z()}, y, -z, material, tint, uv);
    quad({low.x(), high.y(), high.z()}, -y, -z, material, tint, uv);
    quad({high.x(), high.y(), high.z()}, -x, -z, material, tint, uv);
    quad({low.x(), low.y(), high.z()}, x, -z, material, tint, uv);
    quad({low.x(), high.y(), high.z()}, x, -y, material, tint, uv);
    quad({low.x(), low.y(), low.z()}, x, y, material, tint, uv);
}

void MeshBuilder::lathe(const std::vector<Vector2f>& profile, Material material, const Vector3f& tint,
                        int segments) const {
    for (std::size_t i = 0; i + 1 < profile.size(); ++i) {
        const Vector2f &a = profile[i], &b = profile[i + 1];
        const Vector2f slope = (b - a).normalized();
        const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
        for (int s = 0; s <= segments; ++s) {
            const float angle = 2 * kPi * static_cast<float>(s) / static_cast<float>(segments);
            const float c = std::cos(angle), n = std::sin(angle);
            const Vector3f normal(slope.y() * c, slope.y() * n, -slope.x());
            vertex({a.x() * c, a.x() * n, a.y()}, normal, {angle * 0.05f, a.y()}, tint);
            vertex({b.x() * c, b.x() * n, b.y()}, normal, {angle * 0.05f, b.y()}, tint);
        }
        for (int s = 0; s < segments; ++s) {
            const auto k = first + 2 * static_cast<std::uint32_t>(s);
            triangle(k, k + 2, k + 1, material);
            triangle(k + 1, k + 2, k + 3, material);
        }
    }
}

void MeshBuilder::ribbon(const std::vector<Vector3f>& curve, const Vector3f& side, float width, Material material,
                         const Vector3f& tint) const {
    const auto first = static_cast<std::uint32_t>(mesh_.vertices.size());
    float length = 0;
    for (std::size_t i = 0; i < curve.size(); ++i) {
        const std::size_t next = std::min(i + 1, curve.size() - 1), before = i == 0 ? 0 : i - 1;
        if (i > 0) length += (curve[i] - curve[i - 1]).norm();
        const float t = static_cast<float>(i) / static_cast<float>(curve.size() - 1);
        const float half = 0.5f * width * std::sqrt(std::sin(kPi * (0.08f + 0.90f * t)));
        const Vector3f normal = side.cross(curve[next] - curve[before]).normalized();
        vertex(curve[i] - half * side, normal, {0.05f - half, length}, tint);
        vertex(curve[i] + half * side, normal, {0.05f + half, length}, tint);
    }
    for (std::uint32_t i = 0; i + 1 < curve.size(); ++i) {
        const std::uint32_t k = first + 2 * i;
        triangle(k, k + 2, k + 1, material);
        triangle(k + 1, k + 2, k + 3, material);
    }
}

}  // namespace posefusion::synth
