#pragma once
#include <cstdint>

#include "engine/core/intrinsics.hpp"
#include "engine/loops/back_end_state.hpp"
#include "engine/map/map_state.hpp"
#include "engine/tracking/tracker_state.hpp"

/// Everything that the next frame depends on, as plain values: returned by Slam::state(), taken by Slam::restore().
namespace posefusion {

struct SlamState {
    Intrinsics camera;
    std::uint32_t frames = 0;  ///< processed so far; number of the next one
    MapState map;
    TrackerState tracking;
    BackEndState back_end;
};

}  // namespace posefusion
