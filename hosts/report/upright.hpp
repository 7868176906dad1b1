#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "engine/slam/slam.hpp"
#include "hosts/io/trajectory.hpp"

/// Which way is up. The world of a run is its first camera, which may be tilted.
namespace posefusion {

/// Axes for pictures: origin at the first camera, columns of the rotation are right, forward and up in the run's world.
/// Up is the direction that the map's horizontal surfaces (floor, tables) agree on, next to where cameras held upright
/// have theirs; forward is where the first camera looks, made horizontal.
[[nodiscard]] Eigen::Isometry3d upright_axes(const std::vector<Surfel>& map, const Trajectory& trajectory);

}  // namespace posefusion
