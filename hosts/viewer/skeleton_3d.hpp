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

/// Joints of a person in the world, metres; nullopt: not found, or nothing was measured there.
using Skeleton3d = std::array<std::optional<Eigen::Vector3f>, kJointCount>;

/// Lifts joints to where the depth image sees the body around them. People of whom fewer than two joints can be lifted
/// are left out.
/// @param depth   metres, with the people in it
/// @param labels  people's pixels; empty = every pixel counts
[[nodiscard]] std::vector<Skeleton3d> lift_joints(const People& people, const DepthImage& depth,
                                                  const LabelImage& labels, const Intrinsics& camera,
                                                  const Eigen::Isometry3f& T_world_camera);

}  // namespace posefusion
