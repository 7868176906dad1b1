#include "hosts/synth/person_motion.hpp"

#include <algorithm>
#include <cmath>

#include "hosts/synth/furniture.hpp"

namespace posefusion::synth {
namespace {

constexpr double kRate = 100;          ///< trunk samples per second
constexpr double kLead = 1;            ///< seconds sampled before 0 and after the end
constexpr float kToeOffPitch = 0.62f;  ///< rad
constexpr float kHeelStrikePitch = 0.26f;
constexpr double kHeelRiseTime = 0.20, kFlattenTime = 0.10;  ///< seconds
constexpr float kHipsAboveSeat = 0.085f;                     ///< metres

template <class Value, class Get, class Set>
void box_filter(std::vector<Value>& samples, int half, const Get& get, const Set& set) {
    using Item = std::decay_t<decltype(get(samples[0]))>;
    std::vector<Item> in;
    for (const Value& s : samples) in.push_back(get(s));
    const int n = static_cast<int>(in.size());
    for (int i = 0; i < n; ++i) {
        Item sum = in[static_cast<std::size_t>(std::clamp(i - half, 0, n - 1))];
        for (int k = -half + 1; k <= half; ++k) sum += in[static_cast<std::size_t>(std::clamp(i + k, 0, n - 1))];
        set(samples[static_cast<std::size_t>(i)], Item(sum / static_cast<float>(2 * half + 1)));
    }
}

/// How long a step is compared with a full stride: short ones roll the foot less.
float stride_scale(const Footprint& from, const Footprint& to) {
    return std::min((to.at - from.at).norm() / 0.7f, 1.0f);
}

Vector3f along(float yaw, float ahead, float up) { return {std::cos(yaw) * ahead, std::sin(yaw) * ahead, up}; }

}  // namespace

PersonMotion::PersonMotion(const Proportions& body, MotionPlan plan, double duration, std::uint64_t seed)
    : body_(body),
      plan_(std::move(plan)),
      sway_x_(hash(seed, 1), 0.23),
      sway_y_(hash(seed, 2), 0.17),
      look_(hash(seed, 3), 0.16),
      nod_(hash(seed, 4), 0.25),
      hand_left_(hash(seed, 5), 0.45),
      hand_right_(hash(seed, 6), 0.5),
      lean_(hash(seed, 7), 0.11) {
    Rng rng(hash(seed, 8));
    arm_swing_ = rng.uniform(0.55f, 0.85f);
    habit_ = rng.uniform(0.0f, 1.0f);
    const auto count = static_cast<std::size_t>((duration + 2 * kLead) * kRate) + 2;
    trunk_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double t = static_cast<double>(i) / kRate - kLead;
        const Footprint l = plan_.foot(Left, t), r = plan_.foot(Right, t);
        trunk_[i] = {0.5f * (l.at + r.at), 0.5f * (l.yaw + r.yaw), 0};
    }
    for (const int half : {14, 9}) {  // about one step long altogether: an even pace
        box_filter(
            trunk_, half, [](const Trunk& s) { return s.at; }, [](Trunk& s, const Vector2f& v) { s.at = v; });
        box_filter(
            trunk_, half + 4, [](const Trunk& s) { return s.yaw; }, [](Trunk& s, float v) { s.yaw = v; });
    }
    std::vector<float> limit(count);
    for (std::size_t i = 0; i < count; ++i)
        limit[i] = reachable_height(trunk_[i].at, trunk_[i].yaw, static_cast<double>(i) / kRate - kLead);
    constexpr int kErode = 7;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t a = i > kErode ? i - kErode : 0, b = std::min(i + kErode + 1, count);
        trunk_[i].height = *std::min_element(limit.begin() + static_cast<std::ptrdiff_t>(a),
                                             limit.begin() + static_cast<std::ptrdiff_t>(b));
    }
    box_filter(
        trunk_, kErode, [](const Trunk& s) { return s.height; }, [](Trunk& s, float v) { s.height = v; });
}

/// Highest pelvis from which both legs reach their ankles without stretching out.
float PersonMotion::reachable_height(const Vector2f& hips, float yaw, double t) const {
    const float leg = 0.992f * (body_.thigh + body_.shin);
    float height = body_.ankle_height + leg;
    for (const int side : {Left, Right}) {
        const FootPosture f = foot(side, t);
        const Vector2f hip = hips + sign(side) * body_.hip_half_width * Vector2f(-std::sin(yaw), std::cos(yaw));
        const float aside = (f.ankle.head<2>() - hip).squaredNorm();
        height = std::min(height, f.ankle.z() + std::sqrt(std::max(leg * leg - aside, 0.1f)));
    }
    return height;
}

/// Rolls over heel and ball: the part that touches the floor stays where it is.
FootPosture PersonMotion::foot(int side, double t) const {
    const int i = plan_.step_before(side, t);
    const auto& steps = plan_.steps(side);
    const auto rolled = [&](const Footprint& print, float pitch) {
        const float pivot = pitch > 0 ? body_.ball_ahead : -body_.heel_back;
        const float c = std::cos(pitch), s = std::sin(pitch), h = body_.ankle_height;
        // From the pivot on the floor back to the ankle, turned by the pitch (toes down positive).
        const float ahead = c * -pivot + s * h, up = -s * -pivot + c * h;
        FootPosture f;
        f.ankle = Vector3f(print.at.x(), print.at.y(), 0) + along(print.yaw, pivot + ahead, up);
        f.yaw = print.yaw;
        f.pitch = pitch;
        return f;
    };
    const Footprint here = plan_.print_after(side, i);
    if (i >= 0 && t < steps[static_cast<std::size_t>(i)].land) {
        const Footstep& s = steps[static_cast<std::size_t>(i)];
        const Footprint from = plan_.print_after(side, i - 1);
        const float scale = stride_scale(from, s.to), p = static_cast<float>((t - s.lift) / (s.land - s.lift));
        const FootPosture a = rolled(from, scale * kToeOffPitch), b = rolled(s.to, -scale * kHeelStrikePitch);
        FootPosture f;
        const float q = smoothstep(0, 1, p);
        f.ankle = a.ankle + q * (b.ankle - a.ankle) + Vector3f(0, 0, (0.025f + 0.035f * scale) * std::sin(kPi * p));
        f.yaw = from.yaw + q * (s.to.yaw - from.yaw);
        f.pitch = mix_value(a.pitch, b.pitch, smoothstep(0.05f, 0.85f, p));
        f.toe_pitch = f.pitch * smoothstep(0.0f, 0.25f, p);
        return f;
    }
    float pitch = 0;
    if (i >= 0) {
        const float since = static_cast<float>((t - steps[static_cast<std::size_t>(i)].land) / kFlattenTime);
        pitch -= stride_scale(plan_.print_after(side, i - 1), here) * kHeelStrikePitch * (1 - smoothstep(0, 1, since));
    }
    const auto next = static_cast<std::size_t>(i) + 1;
    if (next < steps.size()) {
        const float until = static_cast<float>((steps[next].lift - t) / kHeelRiseTime);
        pitch += stride_scale(here, steps[next].to) * kToeOffPitch * (1 - smoothstep(0, 1, until));
    }
    FootPosture f = rolled(here, pitch);
    f.toe_pitch = std::min(pitch, 0.0f);
    return f;
}

PersonMotion::Trunk PersonMotion::trunk(double t) const {
    const double x = std::clamp((t + kLead) * kRate, 0.0, static_cast<double>(trunk_.size() - 2));
    const auto i = static_cast<std::size_t>(x);
    const auto f = static_cast<float>(x - static_cast<double>(i));
    const Trunk &a = trunk_[i], &b = trunk_[i + 1];
    return {a.at + f * (b.at - a.at), mix_value(a.yaw, b.yaw, f), mix_value(a.height, b.height, f)};
}

const Sitting* PersonMotion::sitting_at(double t) const {
    for (const Sitting& s : plan_.sittings())
        if (t > s.down && t < s.up) return &s;
    return nullptr;
}

float PersonMotion::seated(double t) const {
    const Sitting* s = sitting_at(t);
    if (!s) return 0;
    if (t < s->seated) return smoothstep(0, 1, static_cast<float>((t - s->down) / (s->seated - s->down)));
    if (t < s->rise) return 1;
    return 1 - smoothstep(0, 1, static_cast<float>((t - s->rise) / (s->up - s->rise)));
}

void PersonMotion::set_arms(Posture& posture, double t) const {
    const float sit = seated(t);
    const Vector2f ahead(std::cos(posture.yaw), std::sin(posture.yaw));
    const float stride = (posture.feet[Left].ankle - posture.feet[Right].ankle).head<2>().dot(ahead) * (1 - sit);
    for (const int side : {Left, Right}) {
        ArmPosture& arm = posture.arms[static_cast<std::size_t>(side)];
        const auto wander = static_cast<float>(side == Left ? hand_left_(t) : hand_right_(t));
        const float swing = -sign(side) * arm_swing_ * stride;
        arm.flexion = 0.03f + swing + 0.04f * wander;
        arm.abduction = 0.17f;
        arm.twist = 0.25f;
        arm.elbow = 0.22f + 0.10f * habit_ + 0.45f * std::max(swing, 0.0f);
        float lift = 0;
        for (const Gesture& g : plan_.gestures()) {
            const float in = smoothstep(0, 0.5f, static_cast<float>(t - g.start)),
                        out = smoothstep(0, 0.5f, static_cast<float>(g.end - t));
            lift = std::max(lift, g.lift[static_cast<std::size_t>(side)] * std::min(in, out));
        }
        arm.flexion += lift * (0.35f + 0.25f * wander);
        arm.elbow += lift * (1.35f + 0.35f * wander);
        arm.twist += lift * (0.25f + 0.3f * wander);
        arm.abduction += lift * 0.10f;
        // Hands on the thighs.
        arm.flexion = mix_value(arm.flexion, 0.30f + 0.5f * lift * 0.3f, sit);
        arm.elbow = mix_value(arm.elbow, 0.95f + 0.6f * lift + 0.05f * wander, sit);
        arm.twist = mix_value(arm.twist, 0.30f, sit);
    }
}

Posture PersonMotion::at(double t) const {
    const Trunk now = trunk(t);
    const float sit = seated(t), bend = 4 * sit * (1 - sit);  // bend: half way down
    Posture posture;
    Vector2f at = now.at;
    float height = now.height - 0.006f;
    if (const Sitting* s = sitting_at(t)) {
        at += sit * (s->hips - at);
        height = mix_value(height, kSeatHeight + kHipsAboveSeat, sit);
    }
    for (const int side : {Left, Right}) posture.feet[static_cast<std::size_t>(side)] = foot(side, t);
    const Vector2f ahead(std::cos(now.yaw), std::sin(now.yaw));
    const float stride = (posture.feet[Left].ankle - posture.feet[Right].ankle).head<2>().dot(ahead) * (1 - sit);
    const float lifted = (posture.feet[Left].ankle.z() - posture.feet[Right].ankle.z());
    const Vector2f sway = 0.008f * (1 - sit) * Vector2f(static_cast<float>(sway_x_(t)), static_cast<float>(sway_y_(t)));
    const float shift = -0.16f * lifted * (1 - sit);  // weight goes over the standing foot
    const Vector2f hips = at + sway + shift * Vector2f(-ahead.y(), ahead.x());
    posture.pelvis = {hips.x(), hips.y(), height};
    posture.yaw = now.yaw - 0.10f * stride;
    posture.pelvis_roll = -0.12f * lifted * (1 - sit);
    posture.pelvis_pitch = 0.45f * bend - 0.10f * sit;
    const Trunk soon = trunk(t + 0.1);
    const float speed = (soon.at - now.at).norm() / 0.1f;
    posture.spine_pitch = 0.02f + 0.035f * speed + 0.50f * bend + 0.03f * sit + 0.02f * static_cast<float>(lean_(t));
    posture.spine_yaw = 0.26f * stride + 0.05f * static_cast<float>(lean_(t + 31));
    posture.spine_roll = 0.10f * lifted * (1 - sit);
    posture.head_yaw = -0.13f * stride + (speed > 0.3f ? 0.12f : 0.32f) * static_cast<float>(look_(t));
    posture.head_pitch = 0.06f + 0.06f * static_cast<float>(nod_(t)) - 0.45f * bend;
    set_arms(posture, t);
    return posture;
}

}  // namespace posefusion::synth
