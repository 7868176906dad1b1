#pragma once
#include <Eigen/Cholesky>

#include "engine/core/matrix6d.hpp"
#include "engine/vulkan/shared_types.hpp"

/// The certainty of a tracked pose.
namespace posefusion {

/// The last Gauss-Newton system, (translation, rotation) in the frame of the previous camera.
[[nodiscard]] inline Matrix6d information_of(const gpu::TrackingRecord& record) {
    Matrix6d H;
    int k = 0;
    for (int i = 0; i < 6; ++i) {
        for (int j = i; j < 6; ++j) H(i, j) = H(j, i) = static_cast<double>(record.hessian[k++]);
    }
    return H;
}

/// Its inverse; zero where it is not positive definite.
[[nodiscard]] inline Matrix6d covariance_of(const gpu::TrackingRecord& record) {
    const Eigen::LDLT<Matrix6d> ldlt(information_of(record));
    return ldlt.isPositive() ? ldlt.solve(Matrix6d::Identity()).eval() : Matrix6d::Zero().eval();
}

}  // namespace posefusion
