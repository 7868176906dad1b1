#pragma once
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

/// Triangle meshes of the static room.
namespace posefusion::synth {

using Eigen::Vector2f;
using Eigen::Vector3f;

using Triangle = std::array<std::uint32_t, 3>;

struct RoomVertex {
    Vector3f position;  ///< metres, world
    Vector3f normal;    ///< unit, outward
    Vector2f uv;        ///< metres along the surface; textures say how many metres they span
    Vector3f tint;      ///< linear RGB, multiplies the texture
};

struct RoomMesh {
    std::vector<RoomVertex> vertices;
    std::vector<Triangle> triangles;
    std::vector<std::uint16_t> material;  ///< per triangle, index of the texture
};

/// A solid that people and the camera must avoid: an upright box turned by `yaw` about z.
struct Obstacle {
    Vector2f center;
    Vector2f half;  ///< half sizes along its own axes, metres
    float yaw = 0;
    float bottom = 0, top = 0;

    [[nodiscard]] float distance(const Vector2f& p) const {
        const Vector2f d = p - center;
        const float c = std::cos(yaw), s = std::sin(yaw);
        const float x = std::abs(c * d.x() + s * d.y()) - half.x(), y = std::abs(-s * d.x() + c * d.y()) - half.y();
        return std::hypot(std::max(x, 0.0f), std::max(y, 0.0f));
    }
    [[nodiscard]] float distance(const Vector3f& p) const {
        const float z = std::max({bottom - p.z(), p.z() - top, 0.0f});
        return std::hypot(distance(Vector2f(p.head<2>())), z);
    }
};

}  // namespace posefusion::synth
