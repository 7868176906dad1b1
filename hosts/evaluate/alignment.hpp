#pragma once
#include <Eigen/Geometry>
#include <array>

#include "hosts/evaluate/pose_matching.hpp"

/// Alignment of the estimate with the ground truth.
namespace posefusion {

enum class AlignmentRule {
    Rigid,   ///< least-squares fit of the positions
    Origin,  ///< the first matched poses coincide
    None,    ///< both use the same world frame
};

inline constexpr std::array kAlignmentRules{AlignmentRule::Rigid, AlignmentRule::Origin, AlignmentRule::None};
[[nodiscard]] const char* name_of(AlignmentRule rule);  ///< "rigid", "origin", "none"

struct TrajectoryAlignmentConfig {
    AlignmentRule rule = AlignmentRule::Rigid;
    bool scale = false;  ///< estimate the scale as well (monocular trajectories)
};

/// p in the estimate is T_groundtruth_estimate * (scale * p) in the ground truth.
struct TrajectoryAlignment {
    double scale = 1;
    Eigen::Isometry3d T_groundtruth_estimate = Eigen::Isometry3d::Identity();
};

/// Umeyama, "Least-Squares Estimation of Transformation Parameters Between Two Point Patterns", PAMI 1991, of the
/// matched positions; the scale, if it is wanted, is always that of this fit. Throws Error: fewer than two matches, or
/// the scale is wanted but the estimate does not move.
[[nodiscard]] TrajectoryAlignment align_trajectories(const Trajectory& groundtruth, const Trajectory& estimate,
                                                     const PoseMatches& matches,
                                                     const TrajectoryAlignmentConfig& config = {});
/// The trajectory, scaled, in its own world.
[[nodiscard]] Trajectory scaled(Trajectory trajectory, double scale);

/// The rigid motion that brings the estimated poses, orientations included, nearest to the true ones. Unlike the fit of
/// the positions it is well determined for a camera that hardly moves or moves along a line. Throws Error when no pose
/// can be associated.
[[nodiscard]] Eigen::Isometry3d align_poses(const Trajectory& groundtruth, const Trajectory& estimate,
                                            const MatchingConfig& config = {});

}  // namespace posefusion
