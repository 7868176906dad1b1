#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/core/matrix6d.hpp"
#include "engine/loops/loop_event.hpp"
#include "engine/tracking/tracking_state.hpp"

namespace posefusion {

/// GPU time of one stage of a frame, milliseconds.
struct StageTime {
    std::string name;
    double milliseconds = 0;
};

/// What became of a frame.
struct FrameResult {
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();  ///< world = first camera
    /// The pose before a loop or a relocalisation in this frame corrected it; the same where none did. Seen from the
    /// T_world_camera of the frame before, it is how the camera has really moved.
    Eigen::Isometry3d T_world_tracked = Eigen::Isometry3d::Identity();
    TrackingState tracking = TrackingState::FirstFrame;
    /// The map begins with this frame, since its beginning until now was bad (StartConfig): its camera is the world
    /// now, the frames before have no pose, and frames are counted from this one on.
    bool new_start = false;
    Matrix6d covariance = Matrix6d::Zero();  ///< (translation, rotation), m and rad
    std::uint32_t icp_inliers = 0;           ///< pixels at full resolution, last iteration
    std::uint32_t photometric_inliers = 0;
    float icp_rmse_m = 0;            ///< true RMS of the point-to-plane residuals, metres
    float photometric_rmse = 0;      ///< RMS intensity residual, 0..1
    std::uint32_t valid_pixels = 0;  ///< live pixels with usable static depth
    int iterations = 0;              ///< Gauss-Newton steps made, all levels
    std::uint32_t surfels = 0;       ///< in the map after this frame
    std::uint32_t stable_surfels = 0;
    std::uint64_t device_bytes = 0;    ///< device memory held by the engine
    std::uint32_t keyframes = 0;       ///< places that can be recognised
    std::vector<LoopEvent> loops;      ///< attempts in this frame
    std::vector<StageTime> gpu_times;  ///< in order of execution
};

}  // namespace posefusion
