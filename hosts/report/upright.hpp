#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "engine/slam/slam.hpp"
#include "hosts/io/trajectory.hpp"

/// The vertical direction. The world of a run is its first camera, which may be tilted.
namespace posefusion {

/// Axes for pictures: origin at the first camera, columns of the rotation are right, forward and up in the run's world.
/// Up is the common normal of the map's horizontal surfaces (floor, tables), searched for near the up direction of
/// upright cameras; forward is the viewing direction of the first camera, made horizontal.
[[nodiscard]] Eigen::Isometry3d upright_axes(const std::vector<Surfel>& map, const Trajectory& trajectory);

}  // namespace posefusion
