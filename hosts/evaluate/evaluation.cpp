#include "hosts/evaluate/evaluation.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

/// Index of the nearest stamp: the same binary search as in evaluate_rpe.py, because it determines the result of ties.
std::size_t closest_index(const std::vector<Stamp>& stamps, Stamp t) {
    std::size_t begin = 0, end = stamps.size(), best = 0;
    Stamp difference = std::chrono::abs(stamps[0] - t);
    while (begin < end) {
        const std::size_t middle = (begin + end) / 2;
        if (std::chrono::abs(stamps[middle] - t) < difference) {
            difference = std::chrono::abs(stamps[middle] - t);
            best = middle;
        }
        if (stamps[middle] == t) return middle;
        if (stamps[middle] > t)
            end = middle;
        else
            begin = middle + 1;
    }
    return best;
}

/// evaluate_rpe.py rejects ground-truth poses farther from the estimate than twice the median interval.
Stamp largest_groundtruth_gap(const std::vector<Stamp>& stamps) {
    if (stamps.size() < 2) return Stamp{0};
    std::vector<double> intervals;  // nanoseconds
    for (std::size_t i = 1; i < stamps.size(); ++i)
        intervals.push_back(static_cast<double>((stamps[i] - stamps[i - 1]).count()));
    return Stamp{std::llround(2 * median_of(std::move(intervals)))};
}

Eigen::Isometry3d motion(const Trajectory& trajectory, std::size_t from, std::size_t to) {
    return trajectory[from].T_world_camera.inverse() * trajectory[to].T_world_camera;
}

void add(RelativeError& errors, Stamp stamp, const Eigen::Isometry3d& error) {
    errors.stamps.push_back(stamp);
    errors.translation_errors.push_back(error.translation().norm());
    errors.rotation_errors.push_back(angle_deg(error.linear()));
}

/// evaluate_rpe.py
RelativeError errors_over_time(const Trajectory& groundtruth, const Trajectory& estimate, Stamp delta) {
    const std::vector<Stamp> gt_stamps = stamps_of(groundtruth), est_stamps = stamps_of(estimate);
    const Stamp gap = largest_groundtruth_gap(gt_stamps);
    RelativeError errors;
    for (std::size_t i = 0; i < estimate.size(); ++i) {
        const std::size_t j = closest_index(est_stamps, est_stamps[i] + delta);
        if (j + 1 == estimate.size()) continue;  // most of these are shorter than delta: the benchmark drops them all
        const std::size_t gi = closest_index(gt_stamps, est_stamps[i]), gj = closest_index(gt_stamps, est_stamps[j]);
        if (std::chrono::abs(gt_stamps[gi] - est_stamps[i]) > gap ||
            std::chrono::abs(gt_stamps[gj] - est_stamps[j]) > gap)
            continue;
        // Sturm et al., eq. (1) is Q^-1 P with Q, P the true and the estimated motion. The benchmark's tool computes
        // P Q^-1: the same rotation angle, a slightly different distance. Published numbers come from the tool.
        add(errors, est_stamps[i], motion(estimate, i, j) * motion(groundtruth, gi, gj).inverse());
    }
    return errors;
}

/// evo_rpe
RelativeError errors_over_motion(const Trajectory& groundtruth, const Trajectory& estimate,
                                 const EvaluationConfig& config) {
    Trajectory truth, model;
    for (const auto& [g, e] : match_poses(groundtruth, estimate, config.matching)) {
        truth.push_back(groundtruth[g]);
        model.push_back(estimate[e]);
    }
    RelativeError errors;
    for (const auto& [i, j] : motion_pairs(model, config.rpe.unit, config.rpe.delta, config.rpe.all_pairs))
        add(errors, model[i].stamp, motion(truth, i, j).inverse() * motion(model, i, j));
    return errors;
}

void check(const RelativeErrorConfig& config) {
    constexpr double kMost = 1e9;
    const double least = config.unit == DeltaUnit::Frames ? 1 : 1e-9;
    if (!(config.delta >= least && config.delta <= kMost))
        throw Error(std::string("the delta of the relative error must be ") +
                    (config.unit == DeltaUnit::Frames ? "1 frame or more" : "above 0") + " and at most a billion");
}

}  // namespace

AbsoluteError absolute_trajectory_error(const Trajectory& groundtruth, const Trajectory& estimate,
                                        const EvaluationConfig& config) {
    const PoseMatches matches = match_poses(groundtruth, estimate, config.matching);
    if (matches.size() < 2)
        throw Error(
            "only " + std::to_string(matches.size()) + " of " + std::to_string(estimate.size()) +
            " estimated poses have a ground-truth pose within " +
            std::to_string(std::chrono::round<std::chrono::milliseconds>(config.matching.max_difference).count()) +
            " ms, two are needed; do the two files belong to the same recording?");
    const TrajectoryAlignment alignment = align_trajectories(groundtruth, estimate, matches, config.alignment);
    AbsoluteError result;
    result.scale = alignment.scale;
    result.T_groundtruth_estimate = alignment.T_groundtruth_estimate;
    std::vector<double> angles;
    for (const auto& [g, e] : matches) {
        const Eigen::Isometry3d &truth = groundtruth[g].T_world_camera, &model = estimate[e].T_world_camera;
        const Eigen::Vector3d aligned = result.T_groundtruth_estimate * (result.scale * model.translation());
        const Eigen::Matrix3d R = result.T_groundtruth_estimate.linear() * model.linear();
        result.stamps.push_back(estimate[e].stamp);
        result.errors.push_back((aligned - truth.translation()).norm());
        angles.push_back(angle_deg(truth.linear().transpose() * R));
    }
    result.translation = error_statistics(result.errors);
    result.rotation = error_statistics(std::move(angles));
    return result;
}

std::optional<RelativeError> relative_pose_error(const Trajectory& groundtruth, const Trajectory& estimate,
                                                 const EvaluationConfig& config) {
    if (groundtruth.empty() || estimate.empty()) throw Error("a trajectory without poses cannot be evaluated");
    check(config.rpe);
    const bool by_time = config.rpe.unit == DeltaUnit::Seconds;
    RelativeError result = by_time ? errors_over_time(groundtruth, estimate, stamp_of(config.rpe.delta))
                                   : errors_over_motion(groundtruth, estimate, config);
    if (result.stamps.size() < (by_time ? 2 : 1)) return std::nullopt;
    result.translation = error_statistics(result.translation_errors);
    result.rotation = error_statistics(result.rotation_errors);
    return result;
}

Evaluation evaluate(const Trajectory& groundtruth, const Trajectory& unscaled, const EvaluationConfig& config) {
    Evaluation evaluation;
    evaluation.ate = absolute_trajectory_error(groundtruth, unscaled, config);
    const Trajectory estimate = scaled(unscaled, evaluation.ate.scale);
    evaluation.config = config;
    evaluation.rpe = relative_pose_error(groundtruth, estimate, config);
    evaluation.duration = to_seconds(estimate.back().stamp - estimate.front().stamp);
    const Eigen::Vector3d start = estimate.front().T_world_camera.translation();
    Eigen::Vector3d previous = start;
    for (const StampedPose& pose : estimate) {
        const Eigen::Vector3d position = pose.T_world_camera.translation();
        evaluation.path_length += (position - previous).norm();
        evaluation.max_distance_from_start = std::max(evaluation.max_distance_from_start, (position - start).norm());
        previous = position;
    }
    return evaluation;
}

}  // namespace posefusion
