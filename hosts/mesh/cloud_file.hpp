#pragma once
#include <filesystem>
#include <vector>

#include "engine/slam/slam.hpp"

namespace posefusion {

/// Throws Error unless the name ends in .pcd or .ply.
void check_cloud_name(const std::filesystem::path& file);

/// The surfels as points: PCD 0.7, binary (x y z normal_x normal_y normal_z rgb radius confidence), for PCL and
/// CloudCompare, or PLY as write_ply() writes it, by the name. Written atomically; throws Error.
void write_cloud(const std::filesystem::path& file, const std::vector<Surfel>& surfels);

}  // namespace posefusion
