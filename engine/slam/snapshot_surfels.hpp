#pragma once
#include <cstdint>
#include <vector>

#include "engine/map/surfel.hpp"

namespace posefusion {

struct MapSnapshot;  // engine/slam/map_snapshot.hpp

/// The live surfels of a snapshot, in the order of their slots, for those who know no Vulkan. A run that goes on is
/// hardly held up: they come in slices, between which its commands get their turn. May be called by any thread.
/// @param min_confidence  surfels below it are left out
[[nodiscard]] std::vector<Surfel> read_surfels(const MapSnapshot& snapshot, float min_confidence);

/// The number of the last frame in it, as Surfel::last_seen counts.
[[nodiscard]] std::uint32_t frame_of(const MapSnapshot& snapshot);

}  // namespace posefusion
