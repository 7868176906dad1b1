#pragma once
#include <Eigen/Geometry>

#include "engine/vulkan/shared_types.hpp"

namespace posefusion {

/// Poses are double on the host and float on the device.
[[nodiscard]] inline gpu::Pose to_device(const Eigen::Isometry3d& T) {
    const Eigen::Matrix4f m = T.matrix().cast<float>();
    const auto row = [&](int i) { return gpu::vec4{m(i, 0), m(i, 1), m(i, 2), m(i, 3)}; };
    return {row(0), row(1), row(2)};
}

[[nodiscard]] inline Eigen::Isometry3d from_device(const gpu::Pose& pose) {
    Eigen::Matrix<double, 3, 4> m;
    m << pose.row0.x, pose.row0.y, pose.row0.z, pose.row0.w, pose.row1.x, pose.row1.y, pose.row1.z, pose.row1.w,
        pose.row2.x, pose.row2.y, pose.row2.z, pose.row2.w;
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.linear() = Eigen::Quaterniond(m.leftCols<3>()).normalized().toRotationMatrix();  // float rounding leaves SO(3)
    T.translation() = m.col(3);
    return T;
}

}  // namespace posefusion
