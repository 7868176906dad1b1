#include "hosts/synth/lane_path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "engine/core/error.hpp"

namespace posefusion::synth {
namespace {

// Looking, rad.
constexpr double kOutward = 0.80;       ///< on average, from the direction of walking to the outer side
constexpr double kOutwardRange = 0.25;  ///< more or less, by place
constexpr double kGlance = 0.16;        ///< more or less, by time
constexpr double kAtBareWall = 0.45;    ///< more in the middle of the bare side
constexpr double kDown = 0.13, kNod = 0.06;
constexpr double kWalkRoll = 0.035;
constexpr double kPlaceHz = 0.35;  ///< per turn of the lane
constexpr double kGlanceHz = 0.28, kSwayHz = 0.12;
constexpr double kBareMiddle = 0.46, kBareReach = 0.13;  ///< turns of the lane

// Walking, metres.
constexpr double kStep = 0.70;
constexpr double kBob = 0.012, kSway = 0.015;  ///< up and down with each step, to the sides with every other
constexpr double kAcross = 0.07, kUpAndDown = 0.05;

constexpr double kTurn = 2 * std::numbers::pi;

constexpr double kRamp = 0.2;  ///< share of a stage for getting up to speed, and as much for slowing down

/// 0 to 1 in x = 0..1, at constant speed but for the ends.
double go(double x) {
    constexpr double kEnd = 2 * kRamp * (1 - kRamp);
    if (x < kRamp) return x * x / kEnd;
    if (x > 1 - kRamp) return 1 - (1 - x) * (1 - x) / kEnd;
    return (x - 0.5 * kRamp) / (1 - kRamp);
}

Lane lane_of(const Room& room) {
    if (!room.lane) throw Error("synth: this room has no lane for the camera");
    return *room.lane;
}

double pick(Rng& rng, float low, float high) {
    return rng.chance(0.5f) ? rng.uniform(low, high) : -rng.uniform(low, high);
}

}  // namespace

LanePath::LanePath(const Room& room, Itinerary itinerary, std::uint64_t seed, double pace)
    : lane_(lane_of(room)),
      mirrored_(room.mirrored),
      width_(room.size.x()),
      eye_height_(room.camera_home.z()),
      pace_(pace),
      itinerary_(std::move(itinerary)),
      outward_(hash(seed, 1), kPlaceHz),
      glance_(hash(seed, 2), kGlanceHz),
      nod_(hash(seed, 3), kGlanceHz),
      across_(hash(seed, 4), kSwayHz),
      height_(hash(seed, 5), kSwayHz),
      roll_(hash(seed, 6), kSwayHz),
      hand_(seed) {
    Rng rng(hash(seed, 13));
    sidestep_ = {pick(rng, 0.10f, 0.20f), pick(rng, 0.03f, 0.10f), pick(rng, 0.02f, 0.06f)};
    sidestep_turn_ = pick(rng, 0.07f, 0.16f);
}

LanePath::Progress LanePath::progress(double t) const {
    Progress now;
    for (const WalkStage& stage : itinerary_.stages) {
        const double share = go(stage.time.share(t));
        now.turns += share * (stage.to_turns - now.turns);
        now.sidestep += share * (stage.sidestep - now.sidestep);
    }
    return now;
}

Eigen::Isometry3d LanePath::at(double t) const {
    const Progress now = progress(t);
    const double s = pace_ * t;
    const Eigen::Vector2d ahead = lane_.heading(now.turns).cast<double>(), outer(-ahead.y(), ahead.x());
    const double steps = now.turns * static_cast<double>(lane_.length()) / kStep, phase = kTurn * steps;
    const double aside = kAcross * across_(s) + kSway * std::sin(0.5 * phase) + now.sidestep * sidestep_.y();
    const Eigen::Vector2d floor =
        lane_.at(now.turns).cast<double>() + now.sidestep * sidestep_.x() * ahead + aside * outer;
    const double height = eye_height_ + kUpAndDown * height_(s) + kBob * std::sin(phase) + now.sidestep * sidestep_.z();

    const double place = now.turns - std::floor(now.turns);
    const double bare = std::exp(-0.5 * std::pow((place - kBareMiddle) / (0.5 * kBareReach), 2));
    const double turn = std::atan2(ahead.y(), ahead.x()) + kOutward +
                        kOutwardRange * std::sin(kTurn * place) * outward_(0) + kAtBareWall * bare +
                        kGlance * glance_(s) + now.sidestep * sidestep_turn_;
    const double down = kDown * (1 - bare) + kNod * nod_(s);
    Eigen::Vector3d position(floor.x(), floor.y(), height);
    Eigen::Vector3d forward(std::cos(down) * std::cos(turn), std::cos(down) * std::sin(turn), -std::sin(down));
    if (mirrored_) position.x() = width_ - position.x(), forward.x() = -forward.x();
    return hand_.hold(position, forward, kWalkRoll * roll_(s), t);
}

}  // namespace posefusion::synth
