#pragma once
#include "hosts/io/trajectory.hpp"

namespace posefusion {

/// A ground truth and an estimate with comparable stamps.
struct TrajectoryPair {
    TrajectoryFile groundtruth, estimate;
    bool timed = true;  ///< false: neither file has stamps, poses are matched by their number
};

/// Reads both files. One without stamps (KITTI, matrices) takes those of the other, pose by pose, if both have the same
/// number of poses. Throws Error otherwise, and as read_trajectory_file() does.
/// @param unit  of stamps whose unit is ambiguous
[[nodiscard]] TrajectoryPair read_trajectory_pair(const std::filesystem::path& groundtruth,
                                                  const std::filesystem::path& estimate,
                                                  std::optional<TimeUnit> unit = std::nullopt);

}  // namespace posefusion
