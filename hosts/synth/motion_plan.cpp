#include "hosts/synth/motion_plan.hpp"

#include <algorithm>
#include <cmath>

#include "hosts/synth/floor_plan.hpp"
#include "hosts/synth/random.hpp"

namespace posefusion::synth {
namespace {

constexpr double kStepTime = 0.56;  ///< seconds at pace 1
constexpr double kTurnStepTime = 0.40;
constexpr float kTurnPerStep = 0.85f;  ///< rad
constexpr double kSitTime = 1.35, kRiseTime = 1.25;
constexpr float kToeOut = 0.10f;  ///< rad

/// The heading nearest to `reference` among those that differ by whole turns.
float unwrap(float yaw, float reference) { return yaw + 2 * kPi * std::round((reference - yaw) / (2 * kPi)); }

Vector2f direction(const std::vector<Vector2f>& route, std::size_t i) {
    const std::size_t a = i > 6 ? i - 6 : 0, b = std::min(i + 6, route.size() - 1);
    return (route[b] - route[a]).normalized();
}

/// Points of the route to step to, the last one included: even steps of about `length`, shorter where the route bends,
/// so that the body does not cut corners.
std::vector<std::size_t> step_points(const std::vector<Vector2f>& route, float length) {
    std::vector<float> travelled(route.size(), 0);
    for (std::size_t i = 1; i < route.size(); ++i) {
        const Vector2f before = direction(route, i > 10 ? i - 10 : 0),
                       after = direction(route, std::min(i + 10, route.size() - 1));
        const float bend = std::acos(std::clamp(before.dot(after), -1.0f, 1.0f));
        travelled[i] = travelled[i - 1] + kRouteSpacing * (1 + bend);
    }
    const int count = std::max(1, static_cast<int>(std::lround(travelled.back() / length)));
    std::vector<std::size_t> points;
    for (int k = 1; k <= count; ++k) {
        const float goal = travelled.back() * static_cast<float>(k) / static_cast<float>(count);
        const auto at = std::lower_bound(travelled.begin(), travelled.end(), goal - 1e-4f);
        points.push_back(static_cast<std::size_t>(at - travelled.begin()));
    }
    return points;
}

}  // namespace

MotionPlan::MotionPlan(const Proportions& body, const Vector2f& at, float yaw)
    : half_gait_(0.80f * body.hip_half_width), step_length_(0.385f * body.height) {
    for (const int side : {Left, Right}) start_[static_cast<std::size_t>(side)] = print_beside(side, at, yaw);
}

Footprint MotionPlan::print_beside(int side, const Vector2f& middle, float yaw) const {
    return {middle + sign(side) * half_gait_ * Vector2f(-std::sin(yaw), std::cos(yaw)), yaw + sign(side) * kToeOut};
}

void MotionPlan::step(int side, double start, double duration, const Footprint& to) {
    steps_[static_cast<std::size_t>(side)].push_back({start + 0.10 * duration, start + 0.90 * duration, to});
}

void MotionPlan::walk(const std::vector<Vector2f>& route, float pace) {
    if (route.size() < 2) return;
    const Vector2f heading = direction(route, 0);
    const float ahead = unwrap(std::atan2(heading.y(), heading.x()), yaw());
    if (std::abs(ahead - yaw()) > 0.8f) turn_to(ahead);
    const std::vector<std::size_t> stops = step_points(route, step_length_);
    const int count = static_cast<int>(stops.size());
    const double duration = kStepTime / static_cast<double>(pace);
    float yaw_before = yaw();
    for (int i = 0; i <= count; ++i) {
        const std::size_t index = stops[static_cast<std::size_t>(std::min(i, count - 1))];
        const Vector2f tangent = direction(route, index);
        yaw_before = unwrap(std::atan2(tangent.y(), tangent.x()), yaw_before);
        const int side = i % 2 == 0 ? Left : Right;
        step(side, end_ + duration * i, duration, print_beside(side, route[index], yaw_before));
    }
    end_ += duration * (count + 1);
}

void MotionPlan::turn_to(float target) {
    const float from = yaw(), delta = unwrap(target, from) - from;
    const Vector2f middle = place();
    const int count = static_cast<int>(std::ceil(std::abs(delta) / kTurnPerStep));
    for (int i = 1; i <= count; ++i) {
        const float heading = from + delta * static_cast<float>(i) / static_cast<float>(count);
        const int first = delta > 0 ? Left : Right;
        for (const int side : {first, 1 - first}) {
            step(side, end_, kTurnStepTime, print_beside(side, middle, heading));
            end_ += kTurnStepTime;
        }
    }
}

void MotionPlan::stand(double seconds) { end_ += seconds; }

void MotionPlan::talk(double seconds, const std::array<float, 2>& lift) {
    gestures_.push_back({end_, end_ + seconds, lift});
    end_ += seconds;
}

void MotionPlan::sit(const Vector2f& hips, double seconds) {
    const double seated = end_ + kSitTime, rise = seated + seconds, up = rise + kRiseTime;
    sittings_.push_back({end_, seated, rise, up, hips});
    end_ = up;
}

int MotionPlan::step_before(int side, double t) const {
    const auto& all = steps(side);
    const auto after =
        std::upper_bound(all.begin(), all.end(), t, [](double time, const Footstep& s) { return time < s.lift; });
    return static_cast<int>(after - all.begin()) - 1;
}

Footprint MotionPlan::print_after(int side, int step) const {
    return step < 0 ? start_[static_cast<std::size_t>(side)] : steps(side)[static_cast<std::size_t>(step)].to;
}

Footprint MotionPlan::foot(int side, double t) const {
    const int i = step_before(side, t);
    const Footprint to = print_after(side, i);
    if (i < 0) return to;
    const Footstep& s = steps(side)[static_cast<std::size_t>(i)];
    if (t >= s.land) return to;
    const Footprint from = print_after(side, i - 1);
    const float p = smoothstep(0, 1, static_cast<float>((t - s.lift) / (s.land - s.lift)));
    return {from.at + p * (to.at - from.at), from.yaw + p * (to.yaw - from.yaw)};
}

Vector2f MotionPlan::place_at(double t) const {
    Vector2f p = 0.5f * (foot(Left, t).at + foot(Right, t).at);
    for (const Sitting& s : sittings_)
        if (t > s.down && t < s.up) p = 0.5f * (p + s.hips);
    return p;
}

}  // namespace posefusion::synth
