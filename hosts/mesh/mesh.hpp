#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "engine/core/image.hpp"

namespace posefusion {

struct MeshVertex {
    Eigen::Vector3f position;  ///< metres
    Rgb8 color;
};

/// Triangles, counter-clockwise seen from where the camera was.
struct Mesh {
    std::vector<MeshVertex> vertices;
    std::vector<std::array<std::uint32_t, 3>> faces;  ///< indices of vertices
};

}  // namespace posefusion
