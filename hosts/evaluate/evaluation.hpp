#pragma once
#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "hosts/evaluate/alignment.hpp"
#include "hosts/evaluate/error_statistics.hpp"
#include "hosts/evaluate/motion_pairs.hpp"
#include "hosts/evaluate/pose_matching.hpp"

/// Trajectory errors as the TUM RGB-D benchmark defines them (Sturm et al., "A Benchmark for the Evaluation of RGB-D
/// SLAM Systems", IROS 2012, and its tools evaluate_ate.py and evaluate_rpe.py), and, by choice, as evo does.
namespace posefusion {

struct RelativeErrorConfig {
    double delta = 1.0;                   ///< between the two poses of a relative error, above 0
    DeltaUnit unit = DeltaUnit::Seconds;  ///< other than seconds: the pairs of motion_pairs(), errors as evo has them
    bool all_pairs = false;               ///< see motion_pairs(); by seconds it is always all
};

struct EvaluationConfig {
    MatchingConfig matching;
    TrajectoryAlignmentConfig alignment;
    RelativeErrorConfig rpe;
};

/// Absolute trajectory error: distances between matched positions after alignment.
struct AbsoluteError {
    ErrorStatistics translation;  ///< metres
    ErrorStatistics rotation;     ///< degrees between the matched orientations
    double scale = 1;             ///< applied to the estimate first
    Eigen::Isometry3d T_groundtruth_estimate = Eigen::Isometry3d::Identity();  ///< the alignment, after scaling
    std::vector<Stamp> stamps;   ///< of the matched estimate poses, ascending
    std::vector<double> errors;  ///< metres, one per stamp
};

/// Relative pose error: the difference of the motions between two poses.
struct RelativeError {
    ErrorStatistics translation;             ///< metres per delta
    ErrorStatistics rotation;                ///< degrees per delta
    std::vector<Stamp> stamps;               ///< of the first pose of each pair
    std::vector<double> translation_errors;  ///< metres
    std::vector<double> rotation_errors;     ///< degrees
};

struct Evaluation {
    AbsoluteError ate;
    std::optional<RelativeError> rpe;    ///< nullopt: the estimate is too short for pairs
    EvaluationConfig config;             ///< that both were computed with
    double max_distance_from_start = 0;  ///< of the estimated camera, metres; the drift if the camera was at rest
    double path_length = 0;              ///< of the estimate, metres
    std::optional<double> duration;      ///< of the estimate, seconds; nullopt: its poses have no time
};

/// evaluate_ate.py, evo_ape. Throws Error when fewer than two poses can be matched.
[[nodiscard]] AbsoluteError absolute_trajectory_error(const Trajectory& groundtruth, const Trajectory& estimate,
                                                      const EvaluationConfig& config = {});
/// By seconds: evaluate_rpe.py --fixed_delta --delta 1 --delta_unit s, without its cap on the number of pairs; nullopt
/// with fewer than two. Otherwise evo_rpe, between the matched poses, the pairs by the motion of the estimate; nullopt
/// without any. Throws Error when a trajectory is empty or the delta is not positive.
[[nodiscard]] std::optional<RelativeError> relative_pose_error(const Trajectory& groundtruth,
                                                               const Trajectory& estimate,
                                                               const EvaluationConfig& config = {});
/// Both errors and the properties of the estimate, all at the scale of the alignment.
[[nodiscard]] Evaluation evaluate(const Trajectory& groundtruth, const Trajectory& estimate,
                                  const EvaluationConfig& config = {});

/// The output of `posefusion evaluate`: a table, or JSON (metres, degrees).
[[nodiscard]] std::string evaluation_table(const Evaluation& evaluation);
[[nodiscard]] std::string evaluation_json(const Evaluation& evaluation);

}  // namespace posefusion
