#pragma once
#include <cmath>
#include <numbers>

#include "hosts/io/trajectory.hpp"

/// Made trajectories.
namespace posefusion::test {

inline constexpr double kRadPerDeg = std::numbers::pi / 180;

inline Eigen::Isometry3d pose(const Eigen::Vector3d& position, double yaw_deg = 0) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() = position;
    T.linear() = Eigen::AngleAxisd(yaw_deg * kRadPerDeg, Eigen::Vector3d::UnitZ()).toRotationMatrix();
    return T;
}

/// Poses of a bent path that turns as it goes, from 100 s on.
inline Trajectory walk(int frames, double frames_per_second = 30) {
    Trajectory trajectory;
    for (int i = 0; i < frames; ++i) {
        const double t = i / frames_per_second;
        trajectory.push_back({stamp_of(100 + t), pose({std::cos(t), std::sin(2 * t), 0.3 * t}, 20 * t)});
    }
    return trajectory;
}

inline Trajectory moved(const Eigen::Isometry3d& T, Trajectory trajectory) {
    for (StampedPose& p : trajectory) p.T_world_camera = T * p.T_world_camera;
    return trajectory;
}

}  // namespace posefusion::test
