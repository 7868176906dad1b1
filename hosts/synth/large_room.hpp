#pragma once
#include "hosts/synth/furnisher.hpp"

namespace posefusion::synth {

/// A large room around a block of walls. The camera walks around the block: past a furnished south side (where it
/// starts and returns), a west side, a bare north side with hardly any texture, and an east side.
///
/// @param walls  their material
void furnish_large_room(Furnisher& f, Material walls);

}  // namespace posefusion::synth
