#include "hosts/mesh/simplification.hpp"

#include <meshoptimizer.h>

#include <limits>

namespace posefusion {
namespace {

/// The triangles of `corners` with only those vertices that they use, in the order of their use.
Mesh mesh_of(const std::vector<std::uint32_t>& corners, const std::vector<MeshVertex>& vertices) {
    constexpr std::uint32_t kUnused = std::numeric_limits<std::uint32_t>::max();
    std::vector<std::uint32_t> number(vertices.size(), kUnused);
    Mesh mesh;
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
        auto& face = mesh.faces.emplace_back();
        for (std::size_t k = 0; k < face.size(); ++k) {
            const std::uint32_t vertex = corners[i + k];
            if (number[vertex] == kUnused) {
                number[vertex] = static_cast<std::uint32_t>(mesh.vertices.size());
                mesh.vertices.push_back(vertices[vertex]);
            }
            face[k] = number[vertex];
        }
    }
    return mesh;
}

}  // namespace

Mesh simplified(const Mesh& mesh, std::size_t triangles) {
    if (mesh.faces.size() <= triangles) return mesh;
    constexpr float kAnyError = 1;  // of the extent of the mesh: the number of triangles decides
    const std::uint32_t* const indices = mesh.faces.front().data();
    std::vector<std::uint32_t> corners(3 * mesh.faces.size());
    const std::size_t left =
        meshopt_simplify(corners.data(), indices, corners.size(), mesh.vertices.front().position.data(),
                         mesh.vertices.size(), sizeof(MeshVertex), 3 * triangles, kAnyError, 0, nullptr);
    corners.resize(left);
    return mesh_of(corners, mesh.vertices);
}

}  // namespace posefusion
