#include "engine/tracking/sensor_timing.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "engine/core/matrix6d.hpp"
#include "engine/vulkan/shared_types.hpp"

namespace posefusion {
namespace {

/// The normal equations of a pair of frames in its pose and the times.
struct PairSystem {
    Matrix6d pose;
    Eigen::Matrix<double, 6, 3> both;
    Eigen::Matrix3d times = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 6, 1> pose_gradient;
    Eigen::Vector3d times_gradient;
};

PairSystem system_of(std::span<const float> sums) {
    const auto at = [&](gpu::uint column) {
        return static_cast<double>(sums[column]) / SensorTiming::kCorrelatedPixels;
    };
    PairSystem system;
    gpu::uint k = gpu::COLUMN_HESSIAN;
    for (int i = 0; i < 6; ++i) {
        for (int j = i; j < 6; ++j) system.pose(i, j) = system.pose(j, i) = at(k++);
        const auto row = static_cast<gpu::uint>(i);
        system.pose_gradient(i) = at(gpu::COLUMN_GRADIENT + row);
        system.both.row(i) << at(gpu::COLUMN_POSE_DELAY + row), at(gpu::COLUMN_POSE_DEPTH_READOUT + row),
            at(gpu::COLUMN_POSE_COLOR_READOUT + row);
    }
    system.times(0, 0) = at(gpu::COLUMN_TIMES);
    system.times(0, 1) = system.times(1, 0) = at(gpu::COLUMN_TIMES + 1);
    system.times(1, 1) = at(gpu::COLUMN_TIMES + 2);
    system.times(2, 2) = at(gpu::COLUMN_TIMES + 3);
    for (gpu::uint i = 0; i < 3; ++i) system.times_gradient(i) = at(gpu::COLUMN_TIMES_GRADIENT + i);
    return system;
}

}  // namespace

void SensorTiming::add(std::span<const float> sums, const SensorTimes& used) {
    const PairSystem pair = system_of(sums);
    const Eigen::LDLT<Matrix6d> pose(pair.pose);
    if (pose.info() != Eigen::Success || !(pose.vectorD().minCoeff() > 0)) return;  // too little was seen
    const Eigen::Matrix3d information = pair.times - pair.both.transpose() * pose.solve(pair.both);
    const Eigen::Vector3d gradient = pair.times_gradient - pair.both.transpose() * pose.solve(pair.pose_gradient);
    // (information^-1 + kPairSigma^2)^-1, without inverting what may be singular
    const Eigen::Matrix3d damping = Eigen::Matrix3d::Identity() + kPairSigma * kPairSigma * information;
    const Eigen::Matrix3d damped = damping.inverse();
    const Eigen::Matrix3d share = damped * information;
    information_ += 0.5 * (share + share.transpose());
    weighted_ += share * used - damped * gradient;
    ++pairs_;
}

SensorTiming::Estimate SensorTiming::estimate() const {
    const SensorTimes prior_sigma{kDelaySigma, kReadoutSigma, kReadoutSigma};
    Eigen::Matrix3d information = information_;
    information.diagonal() += prior_sigma.cwiseAbs2().cwiseInverse();
    const Eigen::Matrix3d covariance = information.inverse();
    return {covariance * weighted_, covariance.diagonal().cwiseSqrt(), pairs_};
}

}  // namespace posefusion
