#pragma once
#include <filesystem>
#include <optional>

#include "hosts/io/trajectory.hpp"

/// The true poses that lie in a folder of images.
namespace posefusion {

/// groundtruth.txt (TUM, Bonn, ETH3D); else the *.gt.freiburg of an ICL-NUIM recording; else traj.txt of Replica, or a
/// 4x4 matrix per frame: pose/NUMBER.txt (ScanNet), frame-NUMBER.pose.txt (7-Scenes). Matrices belong to frames by
/// their numbers, 30 a second; those of frames that were lost are left out. nullopt where there is none of these.
/// @param y_up  y points up in the camera that belongs to groundtruth.txt (as in ICL-NUIM's); it is turned to ours
[[nodiscard]] std::optional<Trajectory> folder_groundtruth(const std::filesystem::path& folder, bool y_up);

}  // namespace posefusion
