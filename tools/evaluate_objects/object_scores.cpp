#include "tools/evaluate_objects/object_scores.hpp"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "engine/core/error.hpp"
#include "hosts/evaluate/pose_matching.hpp"
#include "tools/evaluate_objects/triangle_distance.hpp"

namespace posefusion {
namespace {

/// The rotation nearest to a sum of rotations (chordal mean).
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& sum) {
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
    Eigen::Vector3d signs(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
    return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

}  // namespace

std::vector<std::optional<std::size_t>> match_objects(const std::vector<TrueObject>& truth,
                                                      const std::vector<EstimatedObject>& estimates,
                                                      const MaskScores& scores) {
    struct Pair {
        std::size_t pixels, truth, estimate;
    };
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < truth.size(); ++i)
        for (std::size_t j = 0; j < estimates.size(); ++j)
            if (const auto both = scores.shared.find({truth[i].label, estimates[j].label}); both != scores.shared.end())
                pairs.push_back({both->second, i, j});
    std::stable_sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.pixels > b.pixels; });
    std::vector<std::optional<std::size_t>> matches(truth.size());
    std::set<std::size_t> taken;
    for (const Pair& pair : pairs)
        if (!matches[pair.truth] && taken.insert(pair.estimate).second) matches[pair.truth] = pair.estimate;
    return matches;
}

ObjectScores score_object(const TrueObject& truth, const EstimatedObject& estimate,
                          const Eigen::Isometry3d& T_truth_run) {
    const PoseMatches matches = match_poses(truth.poses, estimate.poses);
    if (matches.empty()) throw Error("no pose of an object has a true one within 20 ms");
    const auto n = static_cast<double>(matches.size());
    const Eigen::Vector3d middle = truth.mesh.middle();
    // The middle and the axes of the true object in the estimated one's frame, on average.
    Eigen::Vector3d middle_estimated = Eigen::Vector3d::Zero();
    Eigen::Matrix3d turned = Eigen::Matrix3d::Zero();
    const auto estimated_true = [&](const std::pair<std::size_t, std::size_t>& match) {
        return (T_truth_run * estimate.poses[match.second].T_world_camera).inverse() *
               truth.poses[match.first].T_world_camera;
    };
    for (const auto& match : matches) {
        const Eigen::Isometry3d T = estimated_true(match);
        middle_estimated += T * middle / n;
        turned += T.linear();
    }
    const Eigen::Matrix3d R_estimated_true = nearest_rotation(turned);

    ObjectScores scores;
    scores.poses = matches.size();
    double squares = 0, angles = 0;
    for (const auto& match : matches) {
        const Eigen::Isometry3d T = estimated_true(match);
        const double error = (T * middle - middle_estimated).norm();
        const double angle = Eigen::AngleAxisd(R_estimated_true.transpose() * T.linear()).angle();
        squares += error * error, angles += angle * angle;
        scores.max = std::max(scores.max, error);
    }
    scores.ate = std::sqrt(squares / n);
    scores.rotation = std::sqrt(angles / n) * 180 / std::numbers::pi;

    const TriangleDistance distance(truth.mesh);
    scores.surfels = estimate.model.size();
    if (estimate.model.empty()) return scores;
    constexpr float kFar = 0.01f;  // metres
    double sum = 0;
    std::size_t beyond = 0;
    for (const Surfel& surfel : estimate.model) {
        const Eigen::Vector3d there =
            R_estimated_true.transpose() * (surfel.position.cast<double>() - middle_estimated) + middle;
        const float off = distance(there.cast<float>());
        sum += static_cast<double>(off);
        beyond += off > kFar ? 1 : 0;
    }
    scores.surface_mean = sum / static_cast<double>(estimate.model.size());
    scores.surface_beyond_cm = static_cast<double>(beyond) / static_cast<double>(estimate.model.size());
    return scores;
}

}  // namespace posefusion
