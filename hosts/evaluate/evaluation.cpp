#include "hosts/evaluate/evaluation.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

double median_of(std::vector<double> values) {
    const std::size_t middle = values.size() / 2;
    std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(middle), values.end());
    if (values.size() % 2 == 1) return values[middle];
    const double below = *std::max_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(middle));
    return (below + values[middle]) / 2;
}

std::vector<double> stamps_of(const Trajectory& trajectory) {
    std::vector<double> stamps;
    stamps.reserve(trajectory.size());
    for (const StampedPose& pose : trajectory) stamps.push_back(pose.stamp);
    return stamps;
}

/// Index of the nearest stamp: the binary search of evaluate_rpe.py step by step, because in a tie it decides.
std::size_t closest_index(const std::vector<double>& stamps, double t) {
    std::size_t begin = 0, end = stamps.size(), best = 0;
    double difference = std::abs(stamps[0] - t);
    while (begin < end) {
        const std::size_t middle = (begin + end) / 2;
        if (std::abs(stamps[middle] - t) < difference) {
            difference = std::abs(stamps[middle] - t);
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

std::string milliseconds(double seconds) { return std::to_string(std::lround(1000 * seconds)) + " ms"; }

double angle_deg(const Eigen::Matrix3d& rotation) {
    return Eigen::AngleAxisd(rotation).angle() * 180.0 / std::numbers::pi;
}

/// evaluate_rpe.py refuses ground-truth poses farther from the estimate than twice the median interval.
double largest_groundtruth_gap(const std::vector<double>& stamps) {
    if (stamps.size() < 2) return 0;
    std::vector<double> intervals;
    for (std::size_t i = 1; i < stamps.size(); ++i) intervals.push_back(stamps[i] - stamps[i - 1]);
    return 2 * median_of(std::move(intervals));
}

}  // namespace

ErrorStatistics error_statistics(std::vector<double> errors) {
    ErrorStatistics s;
    s.count = errors.size();
    if (errors.empty()) return s;
    const auto n = static_cast<double>(errors.size());
    double squares = 0, deviations = 0;
    for (const double e : errors) squares += e * e;
    s.rmse = std::sqrt(squares / n);
    s.mean = std::accumulate(errors.begin(), errors.end(), 0.0) / n;
    for (const double e : errors) deviations += (e - s.mean) * (e - s.mean);
    s.std = std::sqrt(deviations / n);
    const auto [smallest, largest] = std::minmax_element(errors.begin(), errors.end());
    s.min = *smallest;
    s.max = *largest;
    s.median = median_of(std::move(errors));
    return s;
}

AbsoluteError absolute_trajectory_error(const Trajectory& groundtruth, const Trajectory& estimate,
                                        const EvaluationConfig& config) {
    const auto pairs = associate(stamps_of(groundtruth), stamps_of(estimate), config.max_stamp_difference);
    if (pairs.size() < 2)
        throw Error("only " + std::to_string(pairs.size()) + " of " + std::to_string(estimate.size()) +
                    " estimated poses have a ground-truth pose within " + milliseconds(config.max_stamp_difference) +
                    ", two are needed; do the two files belong to the same recording?");

    const auto n = static_cast<Eigen::Index>(pairs.size());
    Eigen::Matrix3Xd truth(3, n), model(3, n);
    for (Eigen::Index i = 0; i < n; ++i) {
        const auto [g, e] = pairs[static_cast<std::size_t>(i)];
        truth.col(i) = groundtruth[g].T_world_camera.translation();
        model.col(i) = estimate[e].T_world_camera.translation();
    }
    AbsoluteError result;
    result.T_groundtruth_estimate.matrix() = Eigen::umeyama(model, truth, false);
    for (Eigen::Index i = 0; i < n; ++i) {
        result.stamps.push_back(estimate[pairs[static_cast<std::size_t>(i)].second].stamp);
        result.errors.push_back((result.T_groundtruth_estimate * model.col(i) - truth.col(i)).norm());
    }
    result.translation = error_statistics(result.errors);
    return result;
}

std::optional<RelativeError> relative_pose_error(const Trajectory& groundtruth, const Trajectory& estimate,
                                                 const EvaluationConfig& config) {
    if (groundtruth.empty() || estimate.empty()) throw Error("a trajectory without poses cannot be evaluated");
    const std::vector<double> gt_stamps = stamps_of(groundtruth), est_stamps = stamps_of(estimate);
    const double gap = largest_groundtruth_gap(gt_stamps);

    RelativeError result;
    for (std::size_t i = 0; i < estimate.size(); ++i) {
        const std::size_t j = closest_index(est_stamps, est_stamps[i] + config.rpe_delta);
        if (j + 1 == estimate.size()) continue;  // most of these are shorter than delta: the benchmark drops them all
        const std::size_t gi = closest_index(gt_stamps, est_stamps[i]), gj = closest_index(gt_stamps, est_stamps[j]);
        if (std::abs(gt_stamps[gi] - est_stamps[i]) > gap || std::abs(gt_stamps[gj] - est_stamps[j]) > gap) continue;
        // Sturm et al., eq. (1) is Q^-1 P with Q, P the true and the estimated motion. The benchmark's tool computes
        // P Q^-1: the same rotation angle, a slightly different distance. Published numbers come from the tool.
        const Eigen::Isometry3d truth = groundtruth[gi].T_world_camera.inverse() * groundtruth[gj].T_world_camera;
        const Eigen::Isometry3d model = estimate[i].T_world_camera.inverse() * estimate[j].T_world_camera;
        const Eigen::Isometry3d error = model * truth.inverse();
        result.stamps.push_back(est_stamps[i]);
        result.translation_errors.push_back(error.translation().norm());
        result.rotation_errors.push_back(angle_deg(error.linear()));
    }
    if (result.stamps.size() < 2) return std::nullopt;
    result.translation = error_statistics(result.translation_errors);
    result.rotation = error_statistics(result.rotation_errors);
    return result;
}

Eigen::Isometry3d align_poses(const Trajectory& groundtruth, const Trajectory& estimate,
                              const EvaluationConfig& config) {
    const auto pairs = associate(stamps_of(groundtruth), stamps_of(estimate), config.max_stamp_difference);
    if (pairs.empty())
        throw Error("no estimated pose has a ground-truth pose within " + milliseconds(config.max_stamp_difference));
    Eigen::Matrix3d rotations = Eigen::Matrix3d::Zero();
    Eigen::Vector3d truth = Eigen::Vector3d::Zero(), model = Eigen::Vector3d::Zero();
    for (const auto& [g, e] : pairs) {
        rotations += groundtruth[g].T_world_camera.linear() * estimate[e].T_world_camera.linear().transpose();
        truth += groundtruth[g].T_world_camera.translation();
        model += estimate[e].T_world_camera.translation();
    }
    // The rotation nearest to the sum is the chordal mean.
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(rotations, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
    T.translation() = (truth - T.linear() * model) / static_cast<double>(pairs.size());
    return T;
}

Evaluation evaluate(const Trajectory& groundtruth, const Trajectory& estimate, const EvaluationConfig& config) {
    Evaluation evaluation;
    evaluation.ate = absolute_trajectory_error(groundtruth, estimate, config);
    evaluation.rpe = relative_pose_error(groundtruth, estimate, config);
    evaluation.duration = estimate.back().stamp - estimate.front().stamp;
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
