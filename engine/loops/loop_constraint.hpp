#pragma once
#include <Eigen/Core>
#include <cstdint>

namespace posefusion {

/// The point `source` of the map, as created at source_time, belongs at `target`.
struct LoopConstraint {
    Eigen::Vector3d source;
    std::uint32_t source_time = 0;
    Eigen::Vector3d target;
    std::uint32_t target_time = 0;
    bool relative = false;   ///< the target is deformed with the map of target_time
    bool by_camera = false;  ///< the source was seen by the camera of source_time and moves with it
    bool pin = false;        ///< the map of target_time is held in place at the target
};

}  // namespace posefusion
