#include "engine/loops/camera_ties.hpp"

#include <Eigen/Cholesky>

namespace posefusion {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix6d in_axes(const Matrix3d& R, const Matrix6d& m) {
    Matrix6d axes = Matrix6d::Zero();
    axes.topLeftCorner<3, 3>() = axes.bottomRightCorner<3, 3>() = R;
    return axes * m * axes.transpose();
}

/// Transforms an error (v, w) about one centre to another, `arm` away from it.
Matrix6d moved_by(const Vector3d& arm) {
    Matrix6d lever = Matrix6d::Identity();
    lever.topRightCorner<3, 3>() << 0, arm.z(), -arm.y(), -arm.z(), 0, arm.x(), arm.y(), -arm.x(), 0;  // w x arm
    return lever;
}

Matrix6d inverse(const Matrix6d& m) { return m.ldlt().solve(Matrix6d::Identity()); }

}  // namespace

Matrix6d step_covariance(std::span<const GraphCamera> cameras, size_t i, const DeformationConfig& config) {
    const double translation = static_cast<double>(DeformationConfig::kStepTranslationSigma),
                 rotation = static_cast<double>(DeformationConfig::kStepRotationSigma);
    Matrix6d information = cameras[i].information / static_cast<double>(config.correlated_pixels);
    information.diagonal().head<3>().array() += 1 / (translation * translation);
    information.diagonal().tail<3>().array() += 1 / (rotation * rotation);
    const auto& before = cameras[i > 0 ? i - 1 : 0].T_world_camera;  // the frame that `information` refers to
    const Matrix6d lever = moved_by(cameras[i].T_world_camera.translation() - before.translation());
    return lever * in_axes(before.linear(), inverse(information)) * lever.transpose();
}

Matrix6d way_covariance(std::span<const GraphCamera> cameras, size_t from, size_t to, const DeformationConfig& config) {
    Matrix6d sum = Matrix6d::Zero();
    for (size_t i = from + 1; i <= to; ++i) {
        const Matrix6d lever =
            moved_by(cameras[to].T_world_camera.translation() - cameras[i].T_world_camera.translation());
        sum += lever * step_covariance(cameras, i, config) * lever.transpose();
    }
    return sum;
}

double translation_variance(const Matrix6d& covariance) { return covariance.topLeftCorner<3, 3>().trace() / 3; }

Matrix6d whitening(const Matrix6d& covariance) { return inverse(covariance).llt().matrixU(); }

}  // namespace posefusion
