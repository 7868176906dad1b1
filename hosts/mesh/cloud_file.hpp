#pragma once
#include <filesystem>
#include <vector>

#include "engine/slam/slam.hpp"

namespace posefusion {

enum class CloudEncoding { Binary, Text };

/// Throws Error unless the name ends in .pcd, .ply or .xyz.
void check_cloud_name(const std::filesystem::path& file);

/// The surfels as points, by the name:
///   - .pcd: PCD 0.7 (x y z normal_x normal_y normal_z rgb radius confidence), for PCL and CloudCompare
///   - .ply: as write_ply() writes it, always binary
///   - .xyz: lines `x y z nx ny nz red green blue`, always text
/// Written atomically; throws Error.
void write_cloud(const std::filesystem::path& file, const std::vector<Surfel>& surfels,
                 CloudEncoding encoding = CloudEncoding::Binary);

}  // namespace posefusion
