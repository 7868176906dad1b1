#pragma once
#include <Eigen/Geometry>

#include "engine/loops/loop_event.hpp"

namespace posefusion {

/// The outcome of an attempt to close a loop or to relocalise the camera.
struct LoopAttempt {
    LoopEvent event;
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();  ///< pose of the camera, if event.accepted
};

}  // namespace posefusion
