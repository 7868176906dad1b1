#include "hosts/synth/choreography.hpp"

#include <algorithm>
#include <iterator>
#include <limits>
#include <optional>

#include "hosts/synth/random.hpp"

namespace posefusion::synth {
namespace {

constexpr float kPersonalSpace = 0.75f;     ///< metres between two people's middles
constexpr float kStandAheadOfSeat = 0.42f;  ///< feet ahead of the seat's middle before sitting down, metres
constexpr float kHipsBehindSeat = 0.02f;    ///< the hips come to rest this far behind the seat's middle, metres
constexpr int kAttempts = 24;               ///< ideas for the next thing to do
constexpr int kPlans = 6;                   ///< whole plans of which the best is taken
constexpr double kForesight = 2.5;          ///< seconds that a place must stay free after one has come there

Vector2f facing(float yaw) { return {std::cos(yaw), std::sin(yaw)}; }

class Director {
public:
    Director(const Room& room, const FloorPlan& floor, const std::vector<Act>& acts,
             const std::vector<MotionPlan>& others, Rng& rng, const Seat* seat)
        : room_(room), floor_(floor), acts_(acts), others_(others), rng_(rng), seat_(seat) {}

    [[nodiscard]] MotionPlan direct(const Proportions& body, double duration) {
        std::optional<MotionPlan> best;
        float most = -1;
        for (int i = 0; i < kPlans && most < kPersonalSpace; ++i) {
            MotionPlan plan = start(body);
            const Act* act = nullptr;
            while (plan.end() < duration) {
                const bool entrance = act != &act_at(plan.end());
                act = &act_at(plan.end());
                plan = next(plan, entrance);
            }
            const float apart = distance_to_others(plan, 0, duration);
            if (apart > most) best = plan, most = apart;
        }
        return *best;
    }

private:
    [[nodiscard]] float distance_to_others(const MotionPlan& plan, double from, double to) const {
        float nearest = std::numeric_limits<float>::max();
        for (double t = from; t <= to; t += 0.1)
            for (const MotionPlan& other : others_)
                nearest = std::min(nearest, (plan.place_at(t) - other.place_at(t)).norm());
        return nearest;
    }
    [[nodiscard]] const Act& act_at(double t) const {
        const auto after = std::upper_bound(acts_.begin(), acts_.end(), t,
                                            [](double time, const Act& act) { return time < act.from; });
        return after == acts_.begin() ? acts_.front() : *std::prev(after);
    }
    [[nodiscard]] Vector2f any(const std::vector<Vector2f>& places) {
        return places[static_cast<std::size_t>(rng_.index(static_cast<int>(places.size())))];
    }

    [[nodiscard]] MotionPlan start(const Proportions& body) {
        std::optional<MotionPlan> best;
        float most = -1;
        for (int i = 0; i < kAttempts && most < kPersonalSpace; ++i) {
            MotionPlan plan(body, any(acts_.front().spots), rng_.uniform(-kPi, kPi));
            const float apart = distance_to_others(plan, 0, 0.5);
            if (apart > most) best = plan, most = apart;
        }
        return *best;
    }

    /// The plan with one more thing to do: the first idea that keeps people apart, or the least bad one.
    [[nodiscard]] MotionPlan next(const MotionPlan& plan, bool move) {
        std::optional<MotionPlan> best;
        float most = -1;
        for (int i = 0; i < kAttempts && most < kPersonalSpace; ++i) {
            MotionPlan idea = plan;
            extend(idea, move && i < kAttempts / 2);
            if (idea.end() <= plan.end()) continue;
            const float apart = distance_to_others(idea, plan.end(), idea.end() + kForesight);
            if (apart > most) best = idea, most = apart;
        }
        if (!best || most < kPersonalSpace) {
            MotionPlan wait = plan;
            wait.stand(0.5);
            if (!best || distance_to_others(wait, plan.end(), wait.end() + kForesight) > most) best = wait;
        }
        return *best;
    }

    void extend(MotionPlan& plan, bool move) {
        const Act& act = act_at(plan.end());
        const float what = rng_.uniform();
        if (seat_ && what < 0.28f) return go_and_sit(plan);
        if (what < 0.40f && !act.exits.empty()) return leave_and_return(plan, act);
        if (what < 0.80f || move) return void(walk(plan, any(act.spots)));
        if (what < 0.92f) {
            const Vector2f to_camera = room_.camera_home.head<2>() - plan.place();
            plan.turn_to(std::atan2(to_camera.y(), to_camera.x()) + rng_.uniform(-0.9f, 0.9f));
        } else {
            plan.turn_to(plan.yaw() + rng_.uniform(-2.2f, 2.2f));
        }
        plan.talk(rng_.uniform(1.2f, 2.6f), {rng_.uniform(), rng_.chance(0.6f) ? rng_.uniform() : 0.0f});
    }

    bool walk(MotionPlan& plan, const Vector2f& to) {
        if ((to - plan.place()).norm() < 0.5f) return false;
        const auto route = floor_.route(plan.place(), to);
        if (route.empty()) return false;
        plan.walk(route, rng_.uniform(0.9f, 1.12f));
        return true;
    }
    void leave_and_return(MotionPlan& plan, const Act& act) {
        if (!walk(plan, any(act.exits))) return;
        plan.stand(rng_.uniform(0.2f, 1.0f));
        walk(plan, any(act.spots));
    }
    void go_and_sit(MotionPlan& plan) {
        const Vector2f ahead = facing(seat_->yaw), place = seat_->center + kStandAheadOfSeat * ahead;
        if (!walk(plan, place)) return;
        plan.turn_to(seat_->yaw);
        plan.sit(seat_->center - kHipsBehindSeat * ahead, rng_.uniform(2.0f, 5.0f));
    }

    const Room& room_;
    const FloorPlan& floor_;
    const std::vector<Act>& acts_;
    const std::vector<MotionPlan>& others_;
    Rng& rng_;
    const Seat* seat_;
};

}  // namespace

std::vector<MotionPlan> choreograph(const Room& room, const FloorPlan& floor, const std::vector<Act>& acts,
                                    const std::vector<Proportions>& bodies, double duration, std::uint64_t seed,
                                    const std::vector<MotionPlan>& made, const std::vector<MotionPlan>& avoid) {
    std::vector<MotionPlan> plans = made, others = made;
    others.insert(others.end(), avoid.begin(), avoid.end());
    for (std::size_t i = made.size(); i < bodies.size(); ++i) {
        Rng rng(hash(seed, i));
        // A seat belongs to one person only: nobody sits down on somebody's lap.
        const Seat* seat = i < room.seats.size() ? &room.seats[i] : nullptr;
        plans.push_back(Director(room, floor, acts, others, rng, seat).direct(bodies[i], duration));
        others.push_back(plans.back());
    }
    return plans;
}

}  // namespace posefusion::synth
