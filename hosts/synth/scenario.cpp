#include "hosts/synth/scenario.hpp"

#include <algorithm>

#include "engine/core/error.hpp"
#include "hosts/synth/random.hpp"

namespace posefusion {

const char* scenario_name(SynthScenario scenario) {
    switch (scenario) {
        case SynthScenario::Room:
            return "room";
        case SynthScenario::Loop:
            return "loop";
        case SynthScenario::LoopPeople:
            return "loop-people";
        case SynthScenario::Kidnap:
            return "kidnap";
        case SynthScenario::Movers:
            return "movers";
    }
    throw Error("synth: there is no such scenario; use room, loop, loop-people, kidnap or movers");
}

const char* object_name(SynthObjectKind kind) {
    switch (kind) {
        case SynthObjectKind::Cart:
            return "cart";
        case SynthObjectKind::Box:
            return "box";
        case SynthObjectKind::Door:
            return "door";
        case SynthObjectKind::Ball:
            return "ball";
        case SynthObjectKind::Chair:
            return "chair";
        case SynthObjectKind::Screen:
            return "screen";
    }
    throw Error("synth: there is no such object");
}

bool has_walk(SynthScenario scenario) { return scenario != SynthScenario::Room && scenario != SynthScenario::Movers; }

int usual_frames(SynthScenario scenario) {
    constexpr int kRoom = 120, kWalk = 600, kKidnap = 300;
    if (!has_walk(scenario)) return kRoom;
    return scenario == SynthScenario::Kidnap ? kKidnap : kWalk;
}

namespace synth {
namespace {

// Shares of the duration.
constexpr double kLeaves = 0.06;   ///< the camera starts to walk
constexpr double kReturns = 0.80;  ///< it is back at the start
constexpr double kGather = 0.52;   ///< people set out for the loop's place

constexpr double kHalfway = 0.58;  ///< the kidnapped camera has stopped
constexpr double kCloses = 0.60, kClosed = 0.615, kOpens = 0.70, kOpen = 0.715;

// Turns of the lane.
constexpr double kBeyond = 0.03;                                 ///< the camera moves on a little after its return
constexpr double kKidnapWalk = 0.36;                             ///< before the lens is covered
constexpr float kEarliestReturn = 0.03f, kLatestReturn = 0.24f;  ///< the kidnapped camera is carried there
constexpr double kAfterKidnap = 0.06;                            ///< it walks on so far afterwards

}  // namespace

double Interval::share(double t) const { return t <= from ? 0 : t >= to ? 1 : (t - from) / (to - from); }

double Itinerary::cover(double t) const { return cover_closes.share(t) - cover_opens.share(t); }

RoomKind room_kind(SynthScenario scenario) {
    if (scenario == SynthScenario::Movers) return RoomKind::Cleared;
    return has_walk(scenario) ? RoomKind::Large : RoomKind::Living;
}

/// Walks take place in the evening: they are to make the pose drift.
Exposure exposure_of(const SynthConfig& config) {
    return !has_walk(config.scenario) || config.easy ? kDaylight : kEvening;
}

Itinerary make_itinerary(SynthScenario scenario, double duration, std::uint64_t seed) {
    const auto interval = [&](double from, double to) { return Interval{from * duration, to * duration}; };
    if (scenario != SynthScenario::Kidnap) {
        const Interval never{2 * duration, 2 * duration};
        return {{{interval(kLeaves, kReturns), 1, 0}, {interval(kReturns, 1), 1 + kBeyond, 0}}, never, never};
    }
    Rng rng(seed);
    const double there = rng.uniform(kEarliestReturn, kLatestReturn);
    return {{{interval(kLeaves, kHalfway), kKidnapWalk, 0},
             {interval(kClosed, kOpens), there, 1},
             {interval(kOpen, 1), there + kAfterKidnap, 1}},
            interval(kCloses, kClosed),
            interval(kOpens, kOpen)};
}

std::vector<Act> make_acts(SynthScenario scenario, const Room& room, double duration) {
    if (scenario != SynthScenario::LoopPeople) return {{0, room.spots, room.exits}};
    return {{0, room.beside_loop, {}}, {kGather * duration, room.in_front_of_loop, {}}};
}

}  // namespace synth
}  // namespace posefusion
