#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "engine/core/image.hpp"
#include "engine/core/matrix6d.hpp"
#include "engine/core/motion_judge.hpp"
#include "engine/loops/loop_event.hpp"
#include "engine/tracking/tracking_state.hpp"

namespace posefusion {

/// GPU time of one stage of a frame, milliseconds.
struct StageTime {
    std::string name;
    double milliseconds = 0;
};

/// What a frame did to the map as a whole, and with it to the world that poses are in.
enum class MapChange {
    None,
    /// The map was started again with this frame because of a bad beginning (StartConfig): its camera is the new world
    /// frame, earlier frames of the piece have no pose.
    StartedAgain,
    NewPiece,    ///< the camera was lost for long: a new piece of map begins here, its camera is the new world frame
    OtherPiece,  ///< the lost camera was found in another piece: poses are in the world of that piece
    Joined,      ///< another piece was joined to the current one: poses are in the world of the older one
};

/// The result of processing a frame.
struct FrameResult {
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();  ///< world = first camera of the piece of map
    /// The pose before a loop or relocalisation of this frame corrected it; the same if there was none. Relative to the
    /// T_world_camera of the previous frame it is the actual motion of the camera.
    Eigen::Isometry3d T_world_tracked = Eigen::Isometry3d::Identity();
    TrackingState tracking = TrackingState::FirstFrame;
    MapChange map_change = MapChange::None;
    Matrix6d covariance = Matrix6d::Zero();  ///< (translation, rotation), m and rad
    std::uint32_t icp_inliers = 0;           ///< pixels at full resolution, last iteration
    std::uint32_t photometric_inliers = 0;
    float icp_rmse_m = 0;        ///< true RMS of the point-to-plane residuals, metres
    float photometric_rmse = 0;  ///< RMS intensity residual, 0..1
    /// Factors on red, green and blue that bring the frame's colours into the exposure of the map, that of its first
    /// frame: auto exposure and white balance. Not estimated without a pose: those of the frame before.
    std::array<float, 3> exposure = {1, 1, 1};
    std::uint32_t valid_pixels = 0;   ///< live pixels with usable static depth
    int iterations = 0;               ///< Gauss-Newton steps on all levels
    std::uint32_t start_inliers = 0;  ///< features that agree with the StartPose there was to choose; 0: there was none
    bool start_used = false;          ///< tracking started there, not from its own pre-alignment
    std::uint32_t surfels = 0;        ///< in the map after this frame
    std::uint32_t stable_surfels = 0;
    std::uint64_t device_bytes = 0;     ///< device memory held by the engine
    std::uint32_t keyframes = 0;        ///< number of keyframes
    std::vector<LoopEvent> loops;       ///< attempts in this frame
    LabelImage movers;                  ///< what moves and is no person (MotionJudge); empty = nothing
    float moving_share = 0;             ///< of the image
    std::vector<MovingObject> objects;  ///< rigid things among the movers, of an ObjectTracker
    std::vector<StageTime> gpu_times;   ///< in order of execution
};

}  // namespace posefusion
