#include "hosts/features/rigid_motion.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "engine/core/pinhole.hpp"

namespace posefusion {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// A point seen in two frames: where it is in the earlier one, and how the current one measures it.
struct Pair {
    Vector3d earlier, current;  ///< metres, camera frames
    Vector3d seen;              ///< current: u, v (pixels), depth (metres)
    Vector3d inverse_sigma;     ///< of the error of each
};

class MotionSearch {
public:
    MotionSearch(const Features& earlier, const Features& current, std::span<const FeatureMatch> matches,
                 const Intrinsics& camera, const DepthNoise& noise)
        : camera_(camera) {
        for (const FeatureMatch& match : matches) {
            const Feature &a = earlier[match.earlier], &b = current[match.current];
            const double pixel = std::hypot(a.sigma, b.sigma);
            // a corner lies somewhere on its slanted or uneven surface: its depth varies with its position
            const double lateral = pixel * static_cast<double>(b.depth) / static_cast<double>(camera.fx);
            const double depth = std::hypot(static_cast<double>(noise.sigma(a.depth)),
                                            static_cast<double>(noise.sigma(b.depth)), lateral);
            pairs_.push_back(
                {back_project(a.pixel.x(), a.pixel.y(), a.depth, camera).cast<double>(),
                 back_project(b.pixel.x(), b.pixel.y(), b.depth, camera).cast<double>(),
                 {static_cast<double>(b.pixel.x()), static_cast<double>(b.pixel.y()), static_cast<double>(b.depth)},
                 {1 / pixel, 1 / pixel, 1 / depth}});
        }
    }

    [[nodiscard]] std::optional<RigidMotion> find() const {
        const std::size_t least =
            std::max(static_cast<std::size_t>(FeatureConfig::kMinInliers),
                     static_cast<std::size_t>(FeatureConfig::kMinInlierShare * static_cast<float>(pairs_.size())));
        if (pairs_.size() < least) return std::nullopt;
        const Isometry3d first = best_of_triples();
        const auto refined = refine(first);
        if (!refined || refined->inliers < least) return std::nullopt;
        return refined;
    }

private:
    /// Reprojection and depth of a pair under T_current_earlier, in standard deviations; nullopt behind the camera.
    [[nodiscard]] std::optional<Vector3d> error(const Isometry3d& T_current_earlier, const Pair& pair) const {
        const Vector3d p = T_current_earlier * pair.earlier;
        if (p.z() <= 0) return std::nullopt;
        const Eigen::Vector2d pixel = project(p, camera_);
        return (Vector3d(pixel.x(), pixel.y(), p.z()) - pair.seen).cwiseProduct(pair.inverse_sigma);
    }

    static bool agrees(const Vector3d& error) {
        return error.cwiseAbs().maxCoeff() < static_cast<double>(FeatureConfig::kInlierSigmas);
    }

    /// The motion that takes three points to three others.
    [[nodiscard]] Isometry3d align(const std::array<const Pair*, 3>& triple) const {
        Eigen::Matrix3d from, to;
        for (int i = 0; i < 3; ++i) {
            from.col(i) = triple[static_cast<std::size_t>(i)]->earlier;
            to.col(i) = triple[static_cast<std::size_t>(i)]->current;
        }
        return Isometry3d(Eigen::umeyama(from, to, false));
    }

    /// T_current_earlier of the triple with the least truncated error over all pairs.
    [[nodiscard]] Isometry3d best_of_triples() const {
        constexpr double kCut = static_cast<double>(FeatureConfig::kInlierSigmas * FeatureConfig::kInlierSigmas);
        constexpr double kMinArea2 = 1e-4;  // m^4, of twice a triple's triangle: flatter ones fix no rotation
        cv::RNG random(1);                  // the same triples in every run
        Isometry3d best = Isometry3d::Identity();
        double least_cost = std::numeric_limits<double>::infinity();
        const auto n = static_cast<int>(pairs_.size());
        double wanted = FeatureConfig::kMaxTriples;
        for (int i = 0; i < FeatureConfig::kMaxTriples && i < wanted; ++i) {
            std::array<const Pair*, 3> triple{};
            for (const Pair*& pair : triple) pair = &pairs_[static_cast<std::size_t>(random.uniform(0, n))];
            const Vector3d side = triple[1]->earlier - triple[0]->earlier,
                           other = triple[2]->earlier - triple[0]->earlier;
            if (side.cross(other).squaredNorm() < kMinArea2) continue;
            const Isometry3d T = align(triple);
            double cost = 0;
            int inliers = 0;
            for (const Pair& pair : pairs_) {
                const auto e = error(T, pair);
                const double largest = e ? e->cwiseAbs().maxCoeff() : std::numeric_limits<double>::infinity();
                cost += std::min(largest * largest, kCut);
                inliers += largest * largest < kCut ? 1 : 0;
                if (cost >= least_cost) break;
            }
            if (cost >= least_cost) continue;
            least_cost = cost;
            best = T;
            const double share = static_cast<double>(inliers) / n;
            const double clean = std::clamp(share * share * share, 1e-9, 1 - 1e-9);  // probability of a triple
            wanted = std::log(1 - FeatureConfig::kConfidence) / std::log(1 - clean);
        }
        return best;
    }

    [[nodiscard]] std::optional<RigidMotion> refine(Isometry3d T_current_earlier) const {
        constexpr int kSteps = 10;
        constexpr double kConverged = 1e-6;  // metres and radians: far below what features can tell
        Matrix6d H;
        double squares = 0;
        RigidMotion motion;
        for (int step = 0; step < kSteps; ++step) {
            H.setZero();
            Vector6d b = Vector6d::Zero();
            squares = 0;
            motion.inliers = 0;
            for (const Pair& pair : pairs_) {
                const auto e = error(T_current_earlier, pair);
                if (!e || !agrees(*e)) continue;
                ++motion.inliers;
                squares += e->squaredNorm();
                const Vector3d p = T_current_earlier * pair.earlier;
                Eigen::Matrix3d of_point;  // derivative of (u, v, z) by the point
                of_point << camera_.fx / p.z(), 0, -camera_.fx * p.x() / (p.z() * p.z()),  //
                    0, camera_.fy / p.z(), -camera_.fy * p.y() / (p.z() * p.z()),          //
                    0, 0, 1;
                Eigen::Matrix<double, 3, 6> J;  // by a motion (translation, rotation) after T
                J.leftCols<3>() = pair.inverse_sigma.asDiagonal() * of_point;
                for (int k = 0; k < 3; ++k) J.col(3 + k) = J.leftCols<3>() * Vector3d::Unit(k).cross(p);
                const double weight = 1 / (1 + e->squaredNorm() / 4);  // Cauchy, 2 standard deviations
                H += weight * J.transpose() * J;
                b -= weight * J.transpose() * *e;
            }
            const Eigen::LDLT<Matrix6d> ldlt(H);
            if (motion.inliers < 3 || !ldlt.isPositive()) return std::nullopt;
            const Vector6d x = ldlt.solve(b);
            const double angle = x.tail<3>().norm();
            Isometry3d update = Isometry3d::Identity();
            update.translation() = x.head<3>();
            if (angle > 0) update.linear() = Eigen::AngleAxisd(angle, x.tail<3>() / angle).toRotationMatrix();
            T_current_earlier = update * T_current_earlier;
            if (x.norm() < kConverged) break;
        }
        const Eigen::LDLT<Matrix6d> ldlt(H);
        if (!ldlt.isPositive() || !T_current_earlier.matrix().allFinite()) return std::nullopt;
        // errors larger than expected mean a less certain motion
        const double scale = std::max(1.0, squares / (3.0 * motion.inliers));
        motion.T_earlier_current = T_current_earlier.inverse();
        Matrix6d adjoint = Matrix6d::Zero();  // from motions after T_current_earlier to those after its inverse
        const Eigen::Matrix3d R = motion.T_earlier_current.linear();
        const Vector3d t = motion.T_earlier_current.translation();
        Eigen::Matrix3d cross;
        cross << 0, -t.z(), t.y(), t.z(), 0, -t.x(), -t.y(), t.x(), 0;
        adjoint.topLeftCorner<3, 3>() = adjoint.bottomRightCorner<3, 3>() = R;
        adjoint.topRightCorner<3, 3>() = cross * R;
        motion.covariance = scale * adjoint * ldlt.solve(Matrix6d::Identity()) * adjoint.transpose();
        return motion;
    }

    const Intrinsics& camera_;
    std::vector<Pair> pairs_;
};

}  // namespace

std::optional<RigidMotion> motion_between(const Features& earlier, const Features& current,
                                          std::span<const FeatureMatch> matches, const Intrinsics& camera,
                                          const DepthNoise& noise) {
    return MotionSearch(earlier, current, matches, camera, noise).find();
}

}  // namespace posefusion
