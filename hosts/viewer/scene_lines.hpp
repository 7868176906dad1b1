#pragma once
#include <vector>

#include "hosts/io/trajectory.hpp"
#include "hosts/viewer/scene_renderer.hpp"
#include "hosts/viewer/shown_objects.hpp"
#include "hosts/viewer/skeleton_3d.hpp"

/// Lines drawn into the map.
namespace posefusion {

/// The path of the camera, one line per frame; a square at its start.
void add_trajectory(std::vector<Segment>& lines, const std::vector<Eigen::Vector3f>& positions);
/// The camera as a pyramid. @param ok  false: tracking has failed, it is shown in red
void add_frustum(std::vector<Segment>& lines, const Eigen::Isometry3f& T_world_camera, const Intrinsics& camera,
                 bool ok);
/// The path of each object in the colour of its label, a square at its start.
void add_object_paths(std::vector<Segment>& lines, const std::vector<ShownObject>& objects);
/// Joints as squares, limbs as lines; each person in their own colour.
void add_skeletons(std::vector<Segment>& lines, const std::vector<Skeleton3d>& skeletons);

}  // namespace posefusion
