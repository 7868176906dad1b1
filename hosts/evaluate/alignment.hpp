#pragma once
#include <Eigen/Geometry>
#include <array>

#include "hosts/evaluate/pose_matching.hpp"

/// How the world of the estimate lies in that of the ground truth.
namespace posefusion {

enum class AlignmentRule {
    Rigid,   ///< so that the positions fit best, in least squares
    Origin,  ///< so that the first matched poses are the same
    None,    ///< the worlds are the same
};

inline constexpr std::array kAlignmentRules{AlignmentRule::Rigid, AlignmentRule::Origin, AlignmentRule::None};
[[nodiscard]] const char* name_of(AlignmentRule rule);  ///< "rigid", "origin", "none"

struct TrajectoryAlignmentConfig {
    AlignmentRule rule = AlignmentRule::Rigid;
    bool scale = false;  ///< the scale of the estimate is not known (one camera without depth): the one that fits best
};

/// p in the estimate is T_groundtruth_estimate * (scale * p) in the ground truth.
struct TrajectoryAlignment {
    double scale = 1;
    Eigen::Isometry3d T_groundtruth_estimate = Eigen::Isometry3d::Identity();
};

/// Umeyama, "Least-Squares Estimation of Transformation Parameters Between Two Point Patterns", PAMI 1991, of the
/// matched positions; the scale, if it is wanted, is always that of this fit. Throws Error: fewer than two matches, or
/// a scale is wanted of an estimate that does not move.
[[nodiscard]] TrajectoryAlignment align_trajectories(const Trajectory& groundtruth, const Trajectory& estimate,
                                                     const PoseMatches& matches,
                                                     const TrajectoryAlignmentConfig& config = {});
/// The trajectory at that scale, in its own world.
[[nodiscard]] Trajectory scaled(Trajectory trajectory, double scale);

/// The rigid motion that brings the estimated poses, orientations included, nearest to the true ones. Unlike the fit of
/// the positions it is well determined for a camera that hardly moves or moves along a line. Throws Error when no pose
/// can be associated.
[[nodiscard]] Eigen::Isometry3d align_poses(const Trajectory& groundtruth, const Trajectory& estimate,
                                            const MatchingConfig& config = {});

}  // namespace posefusion
