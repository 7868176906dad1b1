#pragma once
#include <vector>

#include "engine/slam/slam.hpp"

/// Pictures of a surfel map from any viewpoint, rendered on the CPU: for reports, not for tracking.
namespace posefusion {

struct MapRenderConfig {
    Rgb8 background{250, 250, 250};
    float ambient = 0.6f;        ///< share of ambient light; the rest is a light at the camera
    float radius_factor = 1.3f;  ///< discs are enlarged by this, so that no gaps remain
    int supersampling = 2;       ///< samples per pixel and axis
};

/// Surfels as z-buffered discs. Back faces are culled: one can look into rooms through walls and ceilings.
[[nodiscard]] ColorImage render_map(const std::vector<Surfel>& surfels, const Intrinsics& camera,
                                    const Eigen::Isometry3d& T_world_camera, const MapRenderConfig& config = {});

/// Camera pose at `eye` looking at `target`; `up` points up in the picture and must not be the viewing direction.
[[nodiscard]] Eigen::Isometry3d look_at(const Eigen::Vector3d& eye, const Eigen::Vector3d& target,
                                        const Eigen::Vector3d& up);

/// A view that shows the whole map except for stray surfels. World frame, metres.
/// @param direction  from the map to the camera
/// @param up         up in the picture
/// @param more       further points that must be in view
[[nodiscard]] Eigen::Isometry3d overview_pose(const std::vector<Surfel>& surfels, const Intrinsics& camera,
                                              const Eigen::Vector3d& direction, const Eigen::Vector3d& up,
                                              const std::vector<Eigen::Vector3d>& more = {});

}  // namespace posefusion
