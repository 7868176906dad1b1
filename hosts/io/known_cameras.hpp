#pragma once
#include <optional>
#include <string>

#include "hosts/io/camera_file.hpp"

/// Cameras of data sets whose folders do not describe them, with published values.
namespace posefusion {

/// One of the TUM RGB-D cameras if the folder name says which one it was (fr1, freiburg2, ...).
[[nodiscard]] std::optional<Camera> tum_camera(const std::string& folder_name);

/// The camera of the renderings of ICL-NUIM (with y pointing down, as everywhere here).
[[nodiscard]] Camera icl_camera();

/// The colour camera of the Bonn RGB-D Dynamic data set.
[[nodiscard]] Camera bonn_camera();

/// The camera of the Replica renderings of iMAP and NICE-SLAM.
[[nodiscard]] Camera replica_camera();

/// tum_camera(), icl_camera() for a folder name of ICL-NUIM (icl, living_room_traj, office_room_traj, frei_png), or
/// bonn_camera() for one of Bonn (rgbd_bonn_...).
[[nodiscard]] std::optional<Camera> known_camera(const std::string& folder_name);

}  // namespace posefusion
