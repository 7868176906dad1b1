#pragma once
#include <Eigen/Core>
#include <cstdint>

#include "engine/core/image.hpp"

namespace posefusion {

/// One element of the map, world frame, metres.
struct Surfel {
    Eigen::Vector3f position;
    Eigen::Vector3f normal;  ///< unit
    Rgb8 color;
    float radius = 0;  ///< metres
    float confidence = 0;
    std::uint32_t created = 0, last_seen = 0;  ///< frame numbers, the first frame is 0
};

}  // namespace posefusion
