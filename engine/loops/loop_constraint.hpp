#pragma once
#include <Eigen/Core>
#include <cstdint>

namespace posefusion {

/// The map at `source`, as it was at source_time, belongs at `target`.
struct LoopConstraint {
    Eigen::Vector3d source;
    std::uint32_t source_time = 0;
    Eigen::Vector3d target;
    std::uint32_t target_time = 0;
    bool relative = false;   ///< the target moves with the map of target_time
    bool by_camera = false;  ///< the source is what the camera of source_time saw and moves with it
    bool pin = false;        ///< the map of target_time is held in place at the target
};

}  // namespace posefusion
