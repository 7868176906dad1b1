#include "hosts/evaluate/alignment.hpp"

#include <Eigen/SVD>
#include <array>
#include <cmath>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

Eigen::Matrix3Xd positions(const Trajectory& trajectory, const PoseMatches& matches, bool of_groundtruth) {
    Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(matches.size()));
    for (Eigen::Index i = 0; i < points.cols(); ++i) {
        const auto [g, e] = matches[static_cast<std::size_t>(i)];
        points.col(i) = trajectory[of_groundtruth ? g : e].T_world_camera.translation();
    }
    return points;
}

TrajectoryAlignment fit_positions(const Eigen::Matrix3Xd& truth, const Eigen::Matrix3Xd& model, bool with_scale) {
    TrajectoryAlignment fit;
    const Eigen::Matrix4d similarity = Eigen::umeyama(model, truth, with_scale);
    if (with_scale) fit.scale = similarity.topLeftCorner<3, 1>().norm();
    if (!std::isfinite(fit.scale) || fit.scale <= 0)
        throw Error("the scale of the estimate cannot be found: one of the trajectories does not move");
    fit.T_groundtruth_estimate.linear() = similarity.topLeftCorner<3, 3>() / fit.scale;
    fit.T_groundtruth_estimate.translation() = similarity.topRightCorner<3, 1>();
    return fit;
}

}  // namespace

const char* name_of(AlignmentRule rule) {
    constexpr std::array<const char*, 3> kNames{"rigid", "origin", "none"};
    return kNames[static_cast<std::size_t>(rule)];
}

TrajectoryAlignment align_trajectories(const Trajectory& groundtruth, const Trajectory& estimate,
                                       const PoseMatches& matches, const TrajectoryAlignmentConfig& config) {
    if (matches.size() < 2) throw Error("fewer than two poses of the estimate have one of the ground truth");
    TrajectoryAlignment alignment;
    if (config.rule == AlignmentRule::Rigid || config.scale)
        alignment =
            fit_positions(positions(groundtruth, matches, true), positions(estimate, matches, false), config.scale);
    if (config.rule == AlignmentRule::None) alignment.T_groundtruth_estimate.setIdentity();
    if (config.rule == AlignmentRule::Origin) {
        const auto [g, e] = matches.front();
        Eigen::Isometry3d first = estimate[e].T_world_camera;
        first.translation() *= alignment.scale;
        alignment.T_groundtruth_estimate = groundtruth[g].T_world_camera * first.inverse();
    }
    return alignment;
}

Trajectory scaled(Trajectory trajectory, double scale) {
    for (StampedPose& pose : trajectory) pose.T_world_camera.translation() *= scale;
    return trajectory;
}

Eigen::Isometry3d align_poses(const Trajectory& groundtruth, const Trajectory& estimate, const MatchingConfig& config) {
    const PoseMatches matches = match_poses(groundtruth, estimate, config);
    if (matches.empty())
        throw Error("no estimated pose has a ground-truth pose within " +
                    std::to_string(std::chrono::round<std::chrono::milliseconds>(config.max_difference).count()) +
                    " ms");
    Eigen::Matrix3d rotations = Eigen::Matrix3d::Zero();
    Eigen::Vector3d truth = Eigen::Vector3d::Zero(), model = Eigen::Vector3d::Zero();
    for (const auto& [g, e] : matches) {
        rotations += groundtruth[g].T_world_camera.linear() * estimate[e].T_world_camera.linear().transpose();
        truth += groundtruth[g].T_world_camera.translation();
        model += estimate[e].T_world_camera.translation();
    }
    // The rotation nearest to the sum is the chordal mean.
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(rotations, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d sign(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = svd.matrixU() * sign.asDiagonal() * svd.matrixV().transpose();
    T.translation() = (truth - T.linear() * model) / static_cast<double>(matches.size());
    return T;
}

}  // namespace posefusion
