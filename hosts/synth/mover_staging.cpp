#include "hosts/synth/mover_staging.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "hosts/synth/mover_shapes.hpp"
#include "hosts/synth/random.hpp"

namespace posefusion::synth {
namespace {

constexpr std::size_t kFewest = 2;    ///< things that move in a recording
constexpr int kIdeas = 1500;          ///< places and paths that are tried for each mover
constexpr float kWellInView = 0.9f;   ///< share of the time: good enough
constexpr float kLeastInView = 0.4f;  ///< share of the time: less is not worth it
constexpr double kTimeStep = 0.1;     ///< at which places are compared, seconds
constexpr float kGap = 0.08f;         ///< between a mover and everything else, metres
constexpr float kPersonRadius = 0.34f, kCarrierRadius = 0.62f;
constexpr float kChairRadius = 0.30f;    ///< of the legs' circle, metres
constexpr float kChairBehind = 0.58f;    ///< middle of a pulled chair behind the person's, metres
constexpr double kPullSmoothing = 0.25;  ///< half of the time over which steps even out, seconds
constexpr float kBoxBeforeHips = 0.17f;  ///< nearest face of a carried box, metres
constexpr float kLargestBox = 0.44f;     ///< its longest side
constexpr float kBoxAboveHips = 0.16f;   ///< its middle
constexpr double kSpeedUp = 0.3;         ///< seconds from standing to full speed
constexpr float kShade = 0.42f;          ///< radius of the ambient shadow of a thing, of its size
constexpr double kShotLength = 0.9;      ///< seconds between cuts of the film
const Vector2f kFilmPan(0.35f, 0.08f);   ///< metres per second
const Vector2f kFilmCut(0.37f, 0.61f);   ///< metres

Vector3f at_height(const Vector2f& p, float z) { return {p.x(), p.y(), z}; }
Isometry3f placed(const Vector3f& origin, float yaw) {
    Isometry3f T = Isometry3f::Identity();
    T.linear() = Eigen::AngleAxisf(yaw, Vector3f::UnitZ()).toRotationMatrix();
    T.translation() = origin;
    return T;
}
float yaw_of(const Vector2f& direction) { return std::atan2(direction.y(), direction.x()); }

/// When something moves: it may do so from the first frame on, or stand for a while first, and may stop again.
struct Course {
    double starts, stops;  ///< seconds

    Course(Rng& rng, double duration) : starts(-1), stops(2 * duration) {
        if (!rng.chance(0.35f)) starts = duration * static_cast<double>(rng.uniform(0.12f, 0.35f));
        if (rng.chance(0.4f)) stops = duration * static_cast<double>(rng.uniform(0.60f, 0.85f));
    }
    /// Seconds of motion at full speed up to `t`.
    [[nodiscard]] double moved(double t) const { return ramp(t - starts) - ramp(t - stops); }

private:
    [[nodiscard]] static double ramp(double t) {
        return t <= 0 ? 0 : t < kSpeedUp ? 0.5 * t * t / kSpeedUp : t - 0.5 * kSpeedUp;
    }
};

/// 0 .. 1 .. 0 in `cycle` seconds, smoothly.
float there_and_back(double moved, double cycle) {
    return 0.5f - 0.5f * static_cast<float>(std::cos(2 * static_cast<double>(kPi) * moved / cycle));
}

/// A straight way on the floor, there and back.
struct Track {
    Vector2f from, to;
    Course course;
    double cycle;  ///< seconds

    [[nodiscard]] Vector2f at(double t) const { return from + there_and_back(course.moved(t), cycle) * (to - from); }
    [[nodiscard]] float travelled(double t) const { return (at(t) - from).norm(); }
};

/// What is taken up on the floor over time.
struct Occupied {
    std::function<Vector2f(double)> at;
    float radius;
};

struct Demand {
    float radius, height;     ///< of what moves; the height is that of its middle
    float shortest, longest;  ///< metres
    float slowest, fastest;   ///< mean speed, metres per second
};

class Stage {
public:
    Stage(const Room& room, const FloorPlan& floor, const InView& in_view, double duration, Rng& rng)
        : room_(room), floor_(floor), in_view_(in_view), duration_(duration), rng_(rng) {}

    void occupy(const Occupied& other) { occupied_.push_back(other); }

    /// A free track of which the camera sees as much as possible.
    [[nodiscard]] std::optional<Track> find(const Demand& demand) {
        std::optional<Track> best;
        float most = kLeastInView;
        for (int i = 0; i < kIdeas && most < kWellInView; ++i) {
            const Track idea = invent(demand);
            if (!free_floor(idea, demand.radius)) continue;
            const float seen = in_view(idea, demand);
            if (seen > most) best = idea, most = seen;
        }
        if (best) occupy({[track = *best](double t) { return track.at(t); }, demand.radius});
        return best;
    }

private:
    [[nodiscard]] Track invent(const Demand& demand) {
        const Vector2f from(rng_.uniform(0, room_.size.x()), rng_.uniform(0, room_.size.y()));
        const float angle = rng_.uniform(-kPi, kPi), length = rng_.uniform(demand.shortest, demand.longest);
        const Vector2f to = from + length * Vector2f(std::cos(angle), std::sin(angle));
        const Course course(rng_, duration_);
        return {from, to, course, 2 * static_cast<double>(length / rng_.uniform(demand.slowest, demand.fastest))};
    }
    [[nodiscard]] bool free_floor(const Track& track, float radius) const {
        constexpr int kPoints = 20;
        for (int i = 0; i <= kPoints; ++i) {
            const float share = static_cast<float>(i) / kPoints;
            if (floor_.clearance(track.from + share * (track.to - track.from)) < radius + kGap) return false;
        }
        for (double t = 0; t <= duration_; t += kTimeStep)
            for (const Occupied& other : occupied_)
                if ((track.at(t) - other.at(t)).norm() < radius + other.radius + kGap) return false;
        return true;
    }
    [[nodiscard]] float in_view(const Track& track, const Demand& demand) const {
        int seen = 0, all = 0;
        for (double t = 0; t <= duration_; t += kTimeStep, ++all)
            seen += in_view_(at_height(track.at(t), demand.height), t) ? 1 : 0;
        return static_cast<float>(seen) / static_cast<float>(all);
    }

    const Room& room_;
    const FloorPlan& floor_;
    const InView& in_view_;
    double duration_;
    Rng& rng_;
    std::vector<Occupied> occupied_;
};

std::optional<Mover> stage_cart(Stage& stage, Rng& rng) {
    const Vector3f size(rng.uniform(0.55f, 0.75f), rng.uniform(0.38f, 0.5f), rng.uniform(0.75f, 1.1f));
    const float radius = 0.5f * size.head<2>().norm();
    const auto track = stage.find({radius, 0.5f * size.z(), 0.7f, 1.8f, 0.35f, 0.8f});
    if (!track) return std::nullopt;
    const float yaw = yaw_of(track->to - track->from) + (rng.chance(0.5f) ? 0.0f : kPi);
    return Mover{SynthObjectKind::Cart,
                 0,
                 cart_mesh(rng, size),
                 {{{0, 0, 0.2f}, kShade * size.y()}},
                 [track = *track, yaw](double t) { return MoverPose{placed(at_height(track.at(t), 0), yaw)}; }};
}

std::optional<Mover> stage_ball(Stage& stage, Rng& rng) {
    const float radius = rng.uniform(0.13f, 0.22f);
    const auto track = stage.find({radius, radius, 0.6f, 1.8f, 0.3f, 0.9f});
    if (!track) return std::nullopt;
    const Vector2f along = (track->to - track->from).normalized();
    const Vector3f axis = Vector3f::UnitZ().cross(at_height(along, 0));  // rolls forward about it
    return Mover{SynthObjectKind::Ball,
                 0,
                 ball_mesh(rng, radius),
                 {{Vector3f::Zero(), 0.8f * radius}},
                 [track = *track, axis, radius](double t) {
                     Isometry3f T = placed(at_height(track.at(t), radius), 0);
                     T.linear() = Eigen::AngleAxisf(track.travelled(t) / radius, axis).toRotationMatrix();
                     return MoverPose{T};
                 }};
}

/// A box in the hands of somebody. @param depth of the box, metres
Isometry3f carried(const Posture& posture, float depth) {
    const float ahead = kBoxBeforeHips + 0.5f * depth;
    const Vector3f reach(ahead * std::cos(posture.yaw), ahead * std::sin(posture.yaw), kBoxAboveHips);
    return placed(posture.pelvis + reach, posture.yaw);
}

/// In somebody's hands; without a carrier it glides through the air as if somebody out of the picture held it.
std::optional<Mover> stage_box(Stage& stage, Rng& rng, const PersonMotion* carrier) {
    const Vector3f size(rng.uniform(0.26f, 0.36f), rng.uniform(0.32f, kLargestBox), rng.uniform(0.22f, 0.32f));
    const std::vector<Shade> shades{{Vector3f::Zero(), kShade * size.z()}};
    if (carrier) {
        return Mover{SynthObjectKind::Box, 0, carton_mesh(rng, size), shades,
                     [carrier, depth = size.x()](double t) { return MoverPose{carried(carrier->at(t), depth)}; }};
    }
    const float height = rng.uniform(0.9f, 1.3f), rise = rng.uniform(-0.25f, 0.25f), turn = rng.uniform(-0.8f, 0.8f);
    const auto track = stage.find({0.5f * size.head<2>().norm(), height, 0.7f, 1.6f, 0.3f, 0.7f});
    if (!track) return std::nullopt;
    const float length = (track->to - track->from).norm(), yaw = yaw_of(track->to - track->from);
    return Mover{SynthObjectKind::Box, 0, carton_mesh(rng, size), shades,
                 [track = *track, height, rise, turn, length, yaw](double t) {
                     const float share = track.travelled(t) / length;
                     return MoverPose{placed(at_height(track.at(t), height + rise * share), yaw + turn * share)};
                 }};
}

Mover stage_door(Rng& rng, const Hinge& hinge, double duration) {
    const Course course(rng, duration);
    const float open = rng.uniform(0.9f, 1.8f), ajar = rng.chance(0.5f) ? 0.0f : rng.uniform(0.1f, 0.5f);
    const double cycle = static_cast<double>(rng.uniform(2.5f, 5.0f));
    return Mover{SynthObjectKind::Door, 0, leaf_mesh(rng, hinge.width, hinge.height, hinge.sense), {}, [=](double t) {
                     const float angle = ajar + (open - ajar) * there_and_back(course.moved(t), cycle);
                     return MoverPose{placed(hinge.foot, hinge.yaw_closed + hinge.sense * angle)};
                 }};
}

Mover stage_chair(Rng& rng, const ChairPull& pull) {
    const float yaw = yaw_of(pull.along) - 0.5f * kPi;  // the backrest goes ahead
    return Mover{SynthObjectKind::Chair, 0, chair_mesh(rng), {{{0, 0, 0.2f}, 0.12f}}, [pull, yaw](double t) {
                     // Steps are uneven, a chair glides.
                     constexpr int kSamples = 24;
                     float ahead = 0;
                     for (int i = 0; i < kSamples; ++i) {
                         const double when = t + kPullSmoothing * ((2 * i + 1.0) / kSamples - 1);
                         ahead += (pull.person.place_at(when) - pull.start).dot(pull.along) / kSamples;
                     }
                     return MoverPose{placed(at_height(pull.start + (ahead - kChairBehind) * pull.along, 0), yaw)};
                 }};
}

/// Pans and cuts.
Mover stage_screen(const ScreenPlace& place) {
    return Mover{SynthObjectKind::Screen, 0, screen_mesh(place.size), {}, [place](double t) {
                     const auto shot = static_cast<float>(std::floor(t / kShotLength));
                     return MoverPose{placed(place.middle, place.yaw),
                                      Vector2f(shot * kFilmCut + static_cast<float>(t) * kFilmPan)};
                 }};
}

}  // namespace

MoverCast::MoverCast(std::uint64_t seed, int people) {
    Rng rng(seed);
    std::array<bool*, 5> all{&cart, &box, &door, &ball, &chair};
    for (int i = static_cast<int>(all.size()) - 1; i > 0; --i)
        std::swap(all[static_cast<std::size_t>(i)], all[static_cast<std::size_t>(rng.index(i + 1))]);
    const int count = 2 + rng.index(3);
    for (int i = 0; i < count; ++i) *all[static_cast<std::size_t>(i)] = true;
    if (people == 0 && chair) chair = false, cart = true;  // a chair needs somebody who pulls it
}

std::optional<ChairPull> plan_chair_pull(const FloorPlan& floor, const Room& room, const Proportions& body,
                                         const InView& in_view, double duration, std::uint64_t seed) {
    Rng rng(seed);
    const double wait = rng.chance(0.35f) ? 0.0 : duration * static_cast<double>(rng.uniform(0.12f, 0.3f));
    std::optional<ChairPull> best;
    float most = kLeastInView;
    for (int i = 0; i < kIdeas && most < kWellInView; ++i) {
        const Vector2f start(rng.uniform(0, room.size.x()), rng.uniform(0, room.size.y()));
        const float angle = rng.uniform(-kPi, kPi), length = rng.uniform(1.2f, 2.2f);
        const Vector2f along(std::cos(angle), std::sin(angle));
        std::vector<Vector2f> route;
        bool free = true;
        int seen = 0;
        for (float way = -kChairBehind; way <= length && free; way += kRouteSpacing) {
            const Vector2f p = start + way * along;
            free = floor.clearance(p) >= kChairRadius + kGap;
            if (way < 0) continue;
            route.push_back(p);
            seen += in_view(at_height(p - kChairBehind * along, 0.45f), wait + 1.4 * static_cast<double>(way)) ? 1 : 0;
        }
        if (!free) continue;
        const float share = static_cast<float>(seen) / static_cast<float>(route.size());
        if (share <= most) continue;
        MotionPlan plan(body, start, angle);
        if (wait > 0) plan.stand(wait);
        plan.walk(route, 0.72f);
        while (plan.end() < duration + 1) plan.talk(1.5, {rng.uniform(), rng.uniform()});
        best = ChairPull{plan, start, along}, most = share;
    }
    return best;
}

MotionPlan chair_place(const ChairPull& pull, const Proportions& body) {
    MotionPlan place(body, pull.start - kChairBehind * pull.along, yaw_of(pull.along));
    const auto& steps = pull.person.steps(Left);
    const Vector2f end = pull.person.place() - kChairBehind * pull.along;
    if (steps.empty()) return place;
    place.stand(steps.front().lift);
    std::vector<Vector2f> route;
    for (float way = 0; way <= (end - place.place()).norm(); way += kRouteSpacing)
        route.push_back(place.place() + way * pull.along);
    place.walk(route, 0.72f);
    return place;
}

std::optional<std::size_t> find_carrier(const Room& room, const std::vector<PersonMotion>& motions, std::size_t first,
                                        double duration) {
    for (std::size_t i = first; i < motions.size(); ++i) {
        bool clear = true;
        for (double t = 0; t <= duration && clear; t += kTimeStep)
            clear = room.clearance(carried(motions[i].at(t), kLargestBox).translation()) > 0.5f * kLargestBox + kGap;
        if (clear) return i;
    }
    return std::nullopt;
}

std::vector<Mover> stage_movers(const MoverCast& cast, const Room& room, const FloorPlan& floor,
                                const std::vector<MotionPlan>& plans, const std::vector<PersonMotion>& motions,
                                const std::optional<ChairPull>& pull, std::optional<std::size_t> carrier,
                                const InView& in_view, double duration, std::uint64_t seed) {
    Rng rng(seed);
    Stage stage(room, floor, in_view, duration, rng);
    for (std::size_t i = 0; i < plans.size(); ++i)
        stage.occupy(
            {[plan = plans[i]](double t) { return plan.place_at(t); }, carrier == i ? kCarrierRadius : kPersonRadius});
    if (pull)
        stage.occupy(
            {[pull = *pull](double t) { return Vector2f(pull.person.place_at(t) - kChairBehind * pull.along); },
             kChairRadius});
    std::vector<Mover> movers;
    const auto add = [&](std::optional<Mover> mover) {
        if (!mover) return;
        mover->label = kFirstMoverLabel + static_cast<int>(movers.size());
        movers.push_back(std::move(*mover));
    };
    const auto few = [&] { return movers.size() < kFewest; };
    if (cast.door && room.wardrobe) add(stage_door(rng, *room.wardrobe, duration));
    if (pull) add(stage_chair(rng, *pull));
    if (cast.cart) add(stage_cart(stage, rng));
    if (cast.box) add(stage_box(stage, rng, carrier ? &motions[*carrier] : nullptr));
    if (cast.ball) add(stage_ball(stage, rng));
    // Where some have found no place, others move.
    if (few() && !cast.ball) add(stage_ball(stage, rng));
    if (few() && !cast.box) add(stage_box(stage, rng, nullptr));
    if (few() && !cast.door && room.wardrobe) add(stage_door(rng, *room.wardrobe, duration));
    if (room.screen) {
        movers.push_back(stage_screen(*room.screen));
        movers.back().label = 0;
    }
    return movers;
}

}  // namespace posefusion::synth
