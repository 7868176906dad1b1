#include "hosts/report/upright.hpp"

#include <cmath>
#include <numbers>

namespace posefusion {
namespace {

Eigen::Vector3d mean_camera_up(const Trajectory& trajectory) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const StampedPose& pose : trajectory) sum -= pose.T_world_camera.linear().col(1);
    return sum.norm() > 1e-6 ? Eigen::Vector3d(sum.normalized()) : Eigen::Vector3d(-Eigen::Vector3d::UnitY());
}

/// Mean of the normals within `angle` of `up`; `up` itself when there are too few to trust.
Eigen::Vector3d mean_normal_near(const std::vector<Surfel>& map, const Eigen::Vector3d& up, double angle) {
    constexpr double kLeastShare = 0.02;
    const float least_cosine = static_cast<float>(std::cos(angle));
    const Eigen::Vector3f axis = up.cast<float>();
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    std::size_t count = 0;
    for (const Surfel& s : map) {
        if (s.normal.dot(axis) < least_cosine) continue;
        sum += s.normal.cast<double>();
        ++count;
    }
    const bool enough = static_cast<double>(count) > kLeastShare * static_cast<double>(map.size());
    return enough && sum.norm() > 1e-6 ? Eigen::Vector3d(sum.normalized()) : up;
}

}  // namespace

Eigen::Isometry3d upright_axes(const std::vector<Surfel>& map, const Trajectory& trajectory) {
    // Mean shift on the normals: wide first, since cameras look down at things, then close.
    Eigen::Vector3d up = mean_camera_up(trajectory);
    for (const double degrees : {45.0, 30.0, 20.0, 15.0, 10.0, 10.0})
        up = mean_normal_near(map, up, degrees * std::numbers::pi / 180);

    Eigen::Isometry3d axes = Eigen::Isometry3d::Identity();
    Eigen::Isometry3d first = Eigen::Isometry3d::Identity();
    if (!trajectory.empty()) first = trajectory.front().T_world_camera;
    Eigen::Vector3d right = first.linear().col(2).cross(up);
    if (right.norm() < 1e-3) right = first.linear().col(0);  // a camera that looks straight down or up
    right = (right - right.dot(up) * up).normalized();
    axes.linear() << right, up.cross(right), up;
    axes.translation() = first.translation();
    return axes;
}

}  // namespace posefusion
