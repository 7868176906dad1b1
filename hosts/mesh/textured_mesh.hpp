#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/core/image.hpp"

namespace posefusion {

struct TexturedVertex {
    Eigen::Vector3f position;  ///< metres
    Eigen::Vector3f normal;    ///< unit length
    Eigen::Vector2f uv;        ///< in the texture, 0 .. 1 from its upper left corner
};

/// Triangles as those of Mesh, with an image as their colour. Vertices at the border of a part of the image are there
/// once for each part.
struct TexturedMesh {
    std::vector<TexturedVertex> vertices;
    std::vector<std::array<std::uint32_t, 3>> faces;
    ColorImage texture;
    float texel = 0;        ///< metres
    std::size_t views = 0;  ///< that it was made from
};

}  // namespace posefusion
