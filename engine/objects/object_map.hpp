#pragma once
#include <cstdint>
#include <vector>

#include "engine/map/surfel.hpp"

namespace posefusion {

/// The model of an object.
struct ObjectMap {
    std::uint8_t label = 0;
    std::vector<Surfel> surfels;  ///< in the frame of the object
};

}  // namespace posefusion
