#pragma once
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

#include "hosts/io/trajectory.hpp"

/// Pairs of poses for the relative error, other than by time: those of evo.
namespace posefusion {

enum class DeltaUnit { Seconds, Frames, Metres, Degrees };
inline constexpr std::array kDeltaUnits{DeltaUnit::Seconds, DeltaUnit::Frames, DeltaUnit::Metres, DeltaUnit::Degrees};
[[nodiscard]] const char* name_of(DeltaUnit unit);  ///< "s", "frames", "m", "deg"

/// Pairs (i, j) with i < j.
///   - Consecutive: each pair ends where the next begins, at the first pose at which the path length (metres), the sum
///   of the rotations between poses (degrees) or the number of frames reaches `delta`. The first pair begins at the
///   first pose; by metres where the first one that is counted so ends, as in evo.
///   - All, frames: every i and i + delta. Metres: for every i the j whose path length from i is nearest to delta, if
///   it is within a tenth of it. Degrees: every i and j with a rotation between them within a tenth of delta.
/// @param unit   not Seconds
/// @param delta  above 0; rounded down for frames
[[nodiscard]] std::vector<std::pair<std::size_t, std::size_t>> motion_pairs(const Trajectory& trajectory,
                                                                            DeltaUnit unit, double delta, bool all);

/// Angle of a rotation, degrees.
[[nodiscard]] double angle_deg(const Eigen::Matrix3d& rotation);

}  // namespace posefusion
