#pragma once
#include "hosts/io/trajectory.hpp"

namespace posefusion {

/// A ground truth and an estimate, as they were read, with stamps that can be compared.
struct TrajectoryPair {
    TrajectoryFile groundtruth, estimate;
    bool timed = true;  ///< false: neither file has stamps, poses of the same number belong together
};

/// A file without stamps (KITTI, matrices) takes those of the other, pose by pose, if both have equally many. Throws
/// Error otherwise, and as read_trajectory_file() does.
/// @param unit  of stamps that do not tell it themselves
[[nodiscard]] TrajectoryPair read_trajectory_pair(const std::filesystem::path& groundtruth,
                                                  const std::filesystem::path& estimate,
                                                  std::optional<TimeUnit> unit = std::nullopt);

}  // namespace posefusion
