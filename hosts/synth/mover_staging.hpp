#pragma once
#include <functional>
#include <optional>
#include <vector>

#include "hosts/synth/floor_plan.hpp"
#include "hosts/synth/motion_plan.hpp"
#include "hosts/synth/mover.hpp"
#include "hosts/synth/person_motion.hpp"

/// Which things move in a recording, where and when.
namespace posefusion::synth {

/// Whether the camera has a point of the world in view at a time (seconds), and near enough to measure it.
using InView = std::function<bool(const Vector3f& point, double t)>;

/// Somebody who pulls a chair behind in a straight line.
struct ChairPull {
    MotionPlan person;
    Vector2f start = Vector2f::Zero();  ///< where the person stands at first
    Vector2f along = Vector2f::UnitX();
};

/// What moves in a recording, by its seed.
struct MoverCast {
    bool cart = false, box = false, door = false, ball = false, chair = false;
    explicit MoverCast(std::uint64_t seed, int people);
};

/// None if there is no free line to pull a chair along.
[[nodiscard]] std::optional<ChairPull> plan_chair_pull(const FloorPlan& floor, const Room& room,
                                                       const Proportions& body, const InView& in_view, double duration,
                                                       std::uint64_t seed);
/// The place that the pulled chair takes up over time, so that others keep away from it: that of a walker there.
[[nodiscard]] MotionPlan chair_place(const ChairPull& pull, const Proportions& body);

/// The first person from `first` on who could carry a box all the time without pushing it into anything.
[[nodiscard]] std::optional<std::size_t> find_carrier(const Room& room, const std::vector<PersonMotion>& motions,
                                                      std::size_t first, double duration);

/// @param plans, motions  of everybody; of a pull the person is the first. `motions` must outlive the movers
/// @param carrier         of the box; none: it glides through the air
[[nodiscard]] std::vector<Mover> stage_movers(const MoverCast& cast, const Room& room, const FloorPlan& floor,
                                              const std::vector<MotionPlan>& plans,
                                              const std::vector<PersonMotion>& motions,
                                              const std::optional<ChairPull>& pull, std::optional<std::size_t> carrier,
                                              const InView& in_view, double duration, std::uint64_t seed);

}  // namespace posefusion::synth
