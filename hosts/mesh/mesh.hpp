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

/// Unit normals of the vertices: of the triangles around, weighted by their areas; of a vertex without area +z.
[[nodiscard]] std::vector<Eigen::Vector3f> vertex_normals(const Mesh& mesh);

}  // namespace posefusion
