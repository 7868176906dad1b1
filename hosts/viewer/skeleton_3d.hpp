#pragma once
#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <optional>
#include <vector>

#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "pose/joints.hpp"

namespace posefusion {

/// Joints of a person in the world, metres; nullopt: not found, or no depth was measured there.
using Skeleton3d = std::array<std::optional<Eigen::Vector3f>, kJointCount>;

/// Lifts joints to 3-D by the depth of the body around them. People with fewer than two lifted joints are left out.
/// @param depth   metres, with the people in it
/// @param labels  people's pixels; empty = every pixel counts
[[nodiscard]] std::vector<Skeleton3d> lift_joints(const People& people, const DepthImage& depth,
                                                  const LabelImage& labels, const Intrinsics& camera,
                                                  const Eigen::Isometry3f& T_world_camera);

}  // namespace posefusion
