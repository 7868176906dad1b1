#pragma once
#include <functional>
#include <string>
#include <vector>

#include "engine/slam/slam.hpp"
#include "hosts/mesh/mesh.hpp"

namespace posefusion {

struct MeshConfig {
    float resolution = 0.02f;  ///< size of the smallest cells of the reconstruction, metres
    float support = 2;  ///< vertices farther than this from every surfel, in cells beyond its radius, are cut off
    int color_neighbours = 4;  ///< surfels whose colours a vertex takes the mean of, by confidence and nearness
};

/// Screened Poisson surface reconstruction (Kazhdan & Hoppe 2013; PCL's implementation) through the surfels and along
/// their normals, then what no surfel supports is cut off. Throws Error: too few surfels, resolution too fine for their
/// extent.
/// @param progress  told what is being done
[[nodiscard]] Mesh reconstruct_mesh(
    const std::vector<Surfel>& surfels, const MeshConfig& config,
    const std::function<void(const std::string&)>& progress = [](const std::string&) {});

}  // namespace posefusion
