#pragma once
#include <Eigen/Geometry>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hosts/io/stamp.hpp"

/// Camera trajectories as the benchmarks write them; ours are in the TUM RGB-D format: lines `stamp tx ty tz qx qy qz
/// qw`, seconds and metres, camera to world.
namespace posefusion {

struct StampedPose {
    Stamp stamp{};
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
};

/// Ascending stamps, no stamp twice.
using Trajectory = std::vector<StampedPose>;

enum class TrajectoryFormat {
    Tum,    ///< 8 columns: stamp, position, quaternion x y z w
    Asl,    ///< 8 columns (ASL, TUM VI) or 17 (EuRoC: velocity and biases follow): stamp, position, quaternion w x y z
    Kitti,  ///< 12 columns, no stamp: the upper three rows of the matrix, one after the other
    Matrices,  ///< 16 columns, no stamp: all four rows (Replica)
};

[[nodiscard]] const char* name_of(TrajectoryFormat format);  ///< "TUM", "ASL / EuRoC", "KITTI", "matrices"

/// A trajectory and how the file was interpreted.
struct TrajectoryFile {
    Trajectory poses;  ///< without stamps in the file: number i of its poses, from 0, is at i seconds
    TrajectoryFormat format = TrajectoryFormat::Tum;
    std::optional<TimeUnit> unit;       ///< nullopt: the file has no stamps
    std::size_t rows = 0;               ///< poses in the file, including those left out
    std::vector<std::string> warnings;  ///< problems that do not prevent the use, one line each

    /// "TUM, stamps in s"
    [[nodiscard]] std::string description() const;
};

/// The format is recognised by the number of columns, and for 8 by the names of columns in a header, or else by commas
/// with stamps in nanoseconds (ASL). The unit of time is recognised (recognise_time_unit(), which `unit` is handed to).
/// Comments, blank lines, words after the numbers, commas, tabs and Windows line ends are fine. As in the benchmark's
/// tools, lines with NaN (camera lost) are left out and of equal stamps the last counts. Throws Error naming file and
/// line for anything else that is not a rigid motion, and for a file without poses.
[[nodiscard]] TrajectoryFile read_trajectory_file(const std::filesystem::path& file,
                                                  std::optional<TimeUnit> unit = std::nullopt);

/// The poses of a file that has stamps. Throws Error for one that has none.
[[nodiscard]] Trajectory read_trajectory(const std::filesystem::path& file);

/// Numbers with 9 decimals; the same poses give the same bytes (q and -q are written alike). read_trajectory_file()
/// recognises all of the formats. Written atomically; throws Error.
/// @param format  Tum: stamps as in seconds_text(), with a title; Asl: 8 columns with the title of EuRoC's csv files,
///                stamps in nanoseconds; Kitti, Matrices: no stamps
void write_trajectory(const std::filesystem::path& file, const Trajectory& trajectory,
                      TrajectoryFormat format = TrajectoryFormat::Tum);

}  // namespace posefusion
