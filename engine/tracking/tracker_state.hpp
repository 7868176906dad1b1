#pragma once
#include "engine/core/byte_stream.hpp"

namespace posefusion {

/// The state that the next frame is tracked against.
struct TrackerState {
    ByteArray record;         ///< gpu::TrackingRecord
    ByteArray previous_live;  ///< image of the rotation-only pre-alignment
    ByteArray model;          ///< the levels' geometry from fine to coarse, then their photometric, then the colours
};

}  // namespace posefusion
