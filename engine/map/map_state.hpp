#pragma once
#include <cstdint>
#include <vector>

#include "engine/core/byte_stream.hpp"
#include "engine/map/surfel.hpp"

namespace posefusion {

/// The map as plain values, returned by SurfelMap::state() and taken by SurfelMap::restore(). A ByteArray holds the
/// bytes of a device buffer (shaders/include/shared_types.h, surfel.glsl).
struct MapState {
    std::uint32_t capacity = 0;  ///< number of slots; when all are used, dead ones are dropped
    std::uint32_t slots = 0;     ///< in use, dead ones included: their order decides the order of later surfels
    std::uint32_t alive = 0;     ///< as counted after the last frame
    ByteArray counters;          ///< gpu::MapRecord
    ByteArray position_confidence, normal_radius, appearance;  ///< kSurfelStreamBytes per slot
};
inline constexpr std::size_t kSurfelStreamBytes = 16;

/// Live surfels, in the order of their slots. Throws Error: the streams differ in length.
/// @param min_confidence  surfels below it are left out
[[nodiscard]] std::vector<Surfel> surfels_of(const MapState& state, float min_confidence);

}  // namespace posefusion
