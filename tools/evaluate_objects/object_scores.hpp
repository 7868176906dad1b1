#pragma once
#include <optional>
#include <vector>

#include "engine/slam/slam.hpp"
#include "tools/evaluate_objects/mask_scores.hpp"
#include "tools/evaluate_objects/object_truth.hpp"

/// Trajectory and model of an estimated object, compared with the true one.
namespace posefusion {

struct EstimatedObject {
    int label = 0;              ///< in the masks of the run
    Trajectory poses;           ///< T_run_object; the world of the run's trajectory
    std::vector<Surfel> model;  ///< in the frame of the object
};

/// Pairs of true and estimated objects by the pixels that they share: the largest share first, each object once.
/// @return  for each true object the index of its estimate
[[nodiscard]] std::vector<std::optional<std::size_t>> match_objects(const std::vector<TrueObject>& truth,
                                                                    const std::vector<EstimatedObject>& estimates,
                                                                    const MaskScores& scores);

struct ObjectScores {
    std::size_t poses = 0;         ///< compared
    double ate = 0;                ///< root mean square error of the object's middle, metres
    double max = 0;                ///< largest error, metres
    double rotation = 0;           ///< root mean square error, degrees
    std::size_t surfels = 0;       ///< of the model
    double surface_mean = 0;       ///< distance of surfels from the true surface, metres
    double surface_beyond_cm = 0;  ///< share of surfels farther than 1 cm from it
};

/// The worlds are aligned by the camera (align_poses()); the frame in which the run has the object is free, as for
/// Co-Fusion (Runz and Agapito, ICRA 2017): one constant offset that fits best, a point and a rotation.
/// @param T_truth_run  from the world of the run to that of the true poses
/// Throws Error if no pose has a true one.
[[nodiscard]] ObjectScores score_object(const TrueObject& truth, const EstimatedObject& estimate,
                                        const Eigen::Isometry3d& T_truth_run);

}  // namespace posefusion
