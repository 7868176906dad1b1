#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "hosts/io/association.hpp"
#include "hosts/io/trajectory.hpp"

/// Trajectory errors as the TUM RGB-D benchmark defines them (Sturm et al., "A Benchmark for the Evaluation of RGB-D
/// SLAM Systems", IROS 2012, and its tools evaluate_ate.py and evaluate_rpe.py).
namespace posefusion {

struct ErrorStatistics {
    std::size_t count = 0;
    double rmse = 0, mean = 0, median = 0, std = 0, min = 0, max = 0;  ///< std over count, not count - 1
};
[[nodiscard]] ErrorStatistics error_statistics(std::vector<double> errors);

struct EvaluationConfig {
    double max_stamp_difference = kMaxStampDifference;  ///< of associated poses, seconds
    double rpe_delta = 1.0;                             ///< time between the two poses of a relative error, seconds
};

/// Absolute trajectory error: distances between associated positions after the best rigid alignment (Horn, no scale).
struct AbsoluteError {
    ErrorStatistics translation;                                               ///< metres
    Eigen::Isometry3d T_groundtruth_estimate = Eigen::Isometry3d::Identity();  ///< the alignment
    std::vector<double> stamps;  ///< of the associated estimate poses, ascending
    std::vector<double> errors;  ///< metres, one per stamp
};

/// Relative pose error over all pairs of poses `rpe_delta` apart.
struct RelativeError {
    ErrorStatistics translation;             ///< metres per delta
    ErrorStatistics rotation;                ///< degrees per delta
    std::vector<double> stamps;              ///< of the first pose of each pair
    std::vector<double> translation_errors;  ///< metres
    std::vector<double> rotation_errors;     ///< degrees
};

struct Evaluation {
    AbsoluteError ate;
    std::optional<RelativeError> rpe;    ///< nullopt: the estimate is too short for two pairs
    double max_distance_from_start = 0;  ///< of the estimated camera, metres; tells drift when the camera was at rest
    double path_length = 0;              ///< of the estimate, metres
    double duration = 0;                 ///< of the estimate, seconds
};

/// evaluate_ate.py. Throws Error when fewer than two poses can be associated.
[[nodiscard]] AbsoluteError absolute_trajectory_error(const Trajectory& groundtruth, const Trajectory& estimate,
                                                      const EvaluationConfig& config = {});
/// evaluate_rpe.py --fixed_delta --delta 1 --delta_unit s, without its cap on the number of pairs. nullopt with fewer
/// than two pairs. Throws Error when a trajectory is empty.
[[nodiscard]] std::optional<RelativeError> relative_pose_error(const Trajectory& groundtruth,
                                                               const Trajectory& estimate,
                                                               const EvaluationConfig& config = {});
[[nodiscard]] Evaluation evaluate(const Trajectory& groundtruth, const Trajectory& estimate,
                                  const EvaluationConfig& config = {});

/// The rigid motion that brings the estimated poses, orientations included, nearest to the true ones. Unlike the
/// alignment of the ATE it is well determined for a camera that hardly moves or moves along a line. Throws Error when
/// no pose can be associated.
[[nodiscard]] Eigen::Isometry3d align_poses(const Trajectory& groundtruth, const Trajectory& estimate,
                                            const EvaluationConfig& config = {});

/// What `posefusion evaluate` prints: a table for people, or JSON (metres, degrees).
[[nodiscard]] std::string evaluation_table(const Evaluation& evaluation);
[[nodiscard]] std::string evaluation_json(const Evaluation& evaluation);

}  // namespace posefusion
