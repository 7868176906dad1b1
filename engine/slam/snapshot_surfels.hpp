#pragma once
#include <vector>

#include "engine/map/surfel.hpp"

namespace posefusion {

struct MapSnapshot;  // engine/slam/map_snapshot.hpp

/// The live surfels of a snapshot, in the order of their slots, for those who know no Vulkan. A run that goes on is
/// hardly held up: they come in slices, between which its commands get their turn. May be called by any thread.
/// @param min_confidence  surfels below it are left out
[[nodiscard]] std::vector<Surfel> read_surfels(const MapSnapshot& snapshot, float min_confidence);

}  // namespace posefusion
