#pragma once
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "engine/slam/slam.hpp"
#include "hosts/mesh/mesh.hpp"

namespace posefusion {

struct MeshConfig {
    float resolution = 0.02f;  ///< size of the smallest cells of the reconstruction, metres
    /// The mesh is cut off where it is farther than this from what was measured, the discs of the surfels; metres.
    /// nullopt: two cells
    std::optional<float> trim{};
    std::size_t max_triangles = 0;  ///< 0 = all
    int color_neighbours =
        4;  ///< number of surfels whose colours a vertex averages, weighted by confidence and distance
};

/// Of the module with PCL, which is loaded when it is first needed; see reconstruct_mesh().
using ReconstructMeshByPcl = void(const std::vector<Surfel>& surfels, const MeshConfig& config,
                                  const std::function<void(const std::string&)>& progress, Mesh& mesh);
extern "C" ReconstructMeshByPcl reconstruct_mesh_by_pcl;

/// Screened Poisson surface reconstruction (Kazhdan & Hoppe 2013; PCL's implementation) from the surfels and their
/// normals; parts that no surfel supports are removed, and what is left is simplified(). Throws Error: too few surfels,
/// or the resolution is too fine for their extent.
/// @param progress  receives a message for each step
[[nodiscard]] Mesh reconstruct_mesh(
    const std::vector<Surfel>& surfels, const MeshConfig& config,
    const std::function<void(const std::string&)>& progress = [](const std::string&) {});

}  // namespace posefusion
