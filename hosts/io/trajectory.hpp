#pragma once
#include <Eigen/Geometry>
#include <filesystem>
#include <vector>

/// Trajectories in the TUM RGB-D format: lines `stamp tx ty tz qx qy qz qw`, seconds and metres, camera to world.
namespace posefusion {

struct StampedPose {
    double stamp = 0;  ///< seconds
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
};

/// Ascending stamps, no stamp twice.
using Trajectory = std::vector<StampedPose>;

/// Comments, blank lines, commas, tabs and Windows line ends are fine. As in the benchmark's tools, lines with NaN
/// (camera lost) are left out and of equal stamps the last counts. Throws Error naming file and line for anything else
/// that is not eight numbers with a quaternion that can be normalised, and for a file without poses.
[[nodiscard]] Trajectory read_trajectory(const std::filesystem::path& file);

/// Stamps with 6 decimals, the rest with 9; same poses, same bytes (q and -q are written alike). Written atomically;
/// throws Error.
void write_trajectory(const std::filesystem::path& file, const Trajectory& trajectory);

}  // namespace posefusion
