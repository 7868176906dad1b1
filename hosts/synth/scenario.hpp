#pragma once
#include <cstdint>
#include <vector>

#include "hosts/synth/choreography.hpp"
#include "hosts/synth/color_camera.hpp"
#include "hosts/synth/synth.hpp"

/// The parts of a scenario: the room, when and how far the camera walks, when the lens is covered, where people are.
/// Everything scales with the duration of the sequence.
namespace posefusion::synth {

/// From `from` to `to` (seconds).
struct Interval {
    double from = 0, to = 0;
    [[nodiscard]] double share(double t) const;  ///< 0 before, 1 after, even between
};

/// The camera moves from the end of the previous stage to `to_turns` of the room's lane, then stands still.
struct WalkStage {
    Interval time;
    double to_turns = 0;
    double sidestep = 0;  ///< 0..1: share of the sidestep reached at the end, see LanePath
};

struct Itinerary {
    std::vector<WalkStage> stages;
    Interval cover_closes, cover_opens;          ///< equal and after the end if the lens is never covered
    [[nodiscard]] double cover(double t) const;  ///< share of the view that is covered, 0..1
};

[[nodiscard]] RoomKind room_kind(SynthScenario scenario);
[[nodiscard]] Exposure exposure_of(const SynthConfig& config);

/// @param duration  seconds
/// For scenarios with a walk.
[[nodiscard]] Itinerary make_itinerary(SynthScenario scenario, double duration, std::uint64_t seed);

[[nodiscard]] std::vector<Act> make_acts(SynthScenario scenario, const Room& room, double duration);

}  // namespace posefusion::synth
