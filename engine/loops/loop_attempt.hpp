#pragma once
#include <Eigen/Geometry>

#include "engine/loops/loop_event.hpp"

namespace posefusion {

/// What came of trying to close a loop or to find the camera.
struct LoopAttempt {
    LoopEvent event;
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();  ///< where the camera is, if event.accepted
};

}  // namespace posefusion
