#pragma once
#include "hosts/synth/furnisher.hpp"

namespace posefusion::synth {

/// A large room round a block of walls. The camera walks round the block: past a furnished south side (where it starts
/// and comes back to), a west side, a bare north side with hardly any texture, and an east side.
///
/// @param walls  their material
void furnish_large_room(Furnisher& f, Material walls);

}  // namespace posefusion::synth
