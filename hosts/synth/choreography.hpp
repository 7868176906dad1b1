#pragma once
#include <vector>

#include "hosts/synth/floor_plan.hpp"
#include "hosts/synth/motion_plan.hpp"

namespace posefusion::synth {

/// Decides what everybody does: walk from place to place round the furniture, stand and talk, sit down and get up,
/// leave the view and come back. People keep their distance from those planned before them.
/// @param bodies    one per person
/// @param duration  seconds that the plans must cover
[[nodiscard]] std::vector<MotionPlan> choreograph(const Room& room, const FloorPlan& floor,
                                                  const std::vector<Proportions>& bodies, double duration,
                                                  std::uint64_t seed);

}  // namespace posefusion::synth
