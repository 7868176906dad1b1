#include "hosts/mesh/mesh.hpp"

#include <Eigen/Geometry>

namespace posefusion {

std::vector<Eigen::Vector3f> vertex_normals(const Mesh& mesh) {
    std::vector<Eigen::Vector3f> normals(mesh.vertices.size(), Eigen::Vector3f::Zero());
    for (const auto& face : mesh.faces) {
        const Eigen::Vector3f &a = mesh.vertices[face[0]].position, &b = mesh.vertices[face[1]].position,
                              &c = mesh.vertices[face[2]].position;
        const Eigen::Vector3f twice_area = (b - a).cross(c - a);
        for (const std::uint32_t corner : face) normals[corner] += twice_area;
    }
    for (Eigen::Vector3f& normal : normals) {
        const float length = normal.stableNorm();
        normal = length > 0 ? Eigen::Vector3f(normal / length) : Eigen::Vector3f(Eigen::Vector3f::UnitZ());
    }
    return normals;
}

}  // namespace posefusion
