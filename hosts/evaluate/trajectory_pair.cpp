#include "hosts/evaluate/trajectory_pair.hpp"

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

/// The stamps of `timed` for poses that are at as many seconds as their number.
void take_stamps(Trajectory& numbered, const Trajectory& timed) {
    for (StampedPose& pose : numbered)
        pose.stamp = timed[static_cast<std::size_t>(pose.stamp / std::chrono::seconds(1))].stamp;
}

}  // namespace

TrajectoryPair read_trajectory_pair(const std::filesystem::path& groundtruth, const std::filesystem::path& estimate,
                                    std::optional<TimeUnit> unit) {
    TrajectoryPair pair{read_trajectory_file(groundtruth, unit), read_trajectory_file(estimate, unit)};
    TrajectoryFile &truth = pair.groundtruth, &model = pair.estimate;
    if (truth.unit && model.unit) return pair;
    pair.timed = truth.unit || model.unit;
    // Poses of a file with stamps can be numbered only if none was left out.
    const std::size_t true_poses = truth.unit ? truth.poses.size() : truth.rows,
                      model_poses = model.unit ? model.poses.size() : model.rows;
    if (true_poses != model_poses)
        throw Error((truth.unit ? estimate : groundtruth).string() +
                    ": has no time stamps, so both files must have equally many poses: the ground truth has " +
                    std::to_string(true_poses) + ", the estimate " + std::to_string(model_poses) +
                    "; give files with stamps (TUM, EuRoC)");
    if (truth.unit) take_stamps(model.poses, truth.poses);
    if (model.unit) take_stamps(truth.poses, model.poses);
    return pair;
}

}  // namespace posefusion
