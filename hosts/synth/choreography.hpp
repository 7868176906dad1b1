#pragma once
#include <vector>

#include "hosts/synth/floor_plan.hpp"
#include "hosts/synth/motion_plan.hpp"

namespace posefusion::synth {

/// Where people are from a given time on.
struct Act {
    double from = 0;              ///< seconds
    std::vector<Vector2f> spots;  ///< places to walk to
    std::vector<Vector2f> exits;  ///< places to leave to; may be empty
};

/// Plans the actions of all people: walk from place to place around the furniture, stand and talk, sit down and get up,
/// leave the view and come back. People keep their distance from those planned before them.
/// @param acts      at least one, the first from 0; at the start of an act people who are elsewhere go to one of its
/// spots
/// @param bodies    one per person
/// @param duration  seconds that the plans must cover
/// @param made      plans of the first people, made already; they stay
/// @param avoid     what else keeps people away
[[nodiscard]] std::vector<MotionPlan> choreograph(const Room& room, const FloorPlan& floor,
                                                  const std::vector<Act>& acts, const std::vector<Proportions>& bodies,
                                                  double duration, std::uint64_t seed,
                                                  const std::vector<MotionPlan>& made = {},
                                                  const std::vector<MotionPlan>& avoid = {});

}  // namespace posefusion::synth
