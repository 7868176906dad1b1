#include "hosts/synth/body.hpp"

#include <algorithm>
#include <cmath>

#include "hosts/synth/random.hpp"
#include "hosts/synth/surface_nets.hpp"

namespace posefusion::synth {
namespace {

// ---- distance fields of the parts. Lengths are in units of the stature; h converts.

float round_cone(const Vector3f& p, const Vector3f& a, const Vector3f& b, float ra, float rb) {
    const Vector3f ab = b - a;
    const float t = std::clamp((p - a).dot(ab) / ab.squaredNorm(), 0.0f, 1.0f);
    return (p - a - t * ab).norm() - mix_value(ra, rb, t);
}

float ellipsoid(const Vector3f& p, const Vector3f& center, const Vector3f& radii) {
    const Vector3f q = (p - center).cwiseQuotient(radii);
    const float k0 = q.norm(), k1 = q.cwiseQuotient(radii).norm();
    return k1 < 1e-6f ? -radii.minCoeff() : k0 * (k0 - 1) / k1;
}

/// Polynomial smooth minimum (Quilez), rounding radius k.
float blend(float a, float b, float k) {
    const float x = std::max(k - std::abs(a - b), 0.0f) / k;
    return std::min(a, b) - 0.25f * x * x * k;
}
float carve(float a, float b, float k) { return -blend(-a, b, k); }  ///< a without b

/// Cross-sections of the trunk: ellipses by height.
struct Section {
    float z, half_width, half_depth, x;
};
constexpr std::array<Section, 11> kMan{{{0.440f, 0.060f, 0.045f, 0.000f},
                                        {0.465f, 0.088f, 0.064f, -0.004f},
                                        {0.505f, 0.097f, 0.069f, -0.006f},
                                        {0.550f, 0.093f, 0.064f, -0.002f},
                                        {0.605f, 0.086f, 0.060f, 0.004f},
                                        {0.665f, 0.092f, 0.064f, 0.005f},
                                        {0.725f, 0.101f, 0.068f, 0.004f},
                                        {0.775f, 0.101f, 0.062f, -0.003f},
                                        {0.803f, 0.092f, 0.050f, -0.008f},
                                        {0.823f, 0.066f, 0.041f, -0.010f},
                                        {0.850f, 0.033f, 0.034f, -0.010f}}};
constexpr std::array<Section, 11> kWoman{{{0.440f, 0.060f, 0.045f, 0.000f},
                                          {0.465f, 0.092f, 0.066f, -0.006f},
                                          {0.505f, 0.101f, 0.070f, -0.008f},
                                          {0.550f, 0.092f, 0.062f, -0.002f},
                                          {0.605f, 0.075f, 0.053f, 0.003f},
                                          {0.665f, 0.080f, 0.056f, 0.005f},
                                          {0.725f, 0.087f, 0.065f, 0.010f},
                                          {0.775f, 0.086f, 0.056f, -0.001f},
                                          {0.803f, 0.079f, 0.044f, -0.007f},
                                          {0.823f, 0.055f, 0.036f, -0.010f},
                                          {0.850f, 0.029f, 0.030f, -0.010f}}};

struct Sculptor {
    const BodyLook& look;
    const Proportions& size;
    const BoneTransforms& bind;
    float h = look.height, g = look.girth;
    float limb = look.woman ? 0.88f : 1.0f;

    [[nodiscard]] Section section(float z) const {
        const auto& table = look.woman ? kWoman : kMan;
        if (z <= table.front().z) return table.front();
        if (z >= table.back().z) return table.back();
        std::size_t i = 1;
        while (table[i].z < z) ++i;
        const float t = smoothstep(0, 1, (z - table[i - 1].z) / (table[i].z - table[i - 1].z));
        const float s = 0.5f * (t + (z - table[i - 1].z) / (table[i].z - table[i - 1].z));
        return {z, mix_value(table[i - 1].half_width, table[i].half_width, s),
                mix_value(table[i - 1].half_depth, table[i].half_depth, s), mix_value(table[i - 1].x, table[i].x, s)};
    }

    /// The trunk between two heights (fractions of the stature), `grow` metres thicker.
    [[nodiscard]] float trunk(const Vector3f& p, float low, float high, float grow) const {
        const Section s = section(p.z() / h);
        const float w = s.half_width * h * g + grow, d = s.half_depth * h * g + grow;
        const float x = p.x() - s.x * h, y = p.y();
        const float k0 = std::hypot(x / d, y / w), k1 = std::hypot(x / (d * d), y / (w * w));
        const float side = k1 < 1e-6f ? -d : k0 * (k0 - 1) / k1;
        return 0.9f * carve(carve(side, p.z() - low * h, 0.02f), high * h - p.z(), 0.02f);
    }
    [[nodiscard]] Vector3f joint(int bone) const { return bind[static_cast<std::size_t>(bone)].translation(); }

    /// Along an arm from the shoulder (0) over the elbow (1) to the wrist (2).
    [[nodiscard]] Vector3f arm_point(int side, float t) const {
        const int b = upper_arm(side);
        return t <= 1 ? Vector3f(joint(b) + t * (joint(b + 1) - joint(b)))
                      : Vector3f(joint(b + 1) + (t - 1) * (joint(b + 2) - joint(b + 1)));
    }
    [[nodiscard]] float arm(const Vector3f& p, int side, float from, float to, float grow) const {
        const float r = h * limb * std::sqrt(g);
        constexpr std::array<float, 5> kAt{0, 0.45f, 1, 1.3f, 2}, kRadius{0.0285f, 0.0275f, 0.0225f, 0.0240f, 0.0155f};
        const auto radius = [&](float t) {
            std::size_t i = 1;
            while (i + 1 < kAt.size() && kAt[i] < t) ++i;
            return r * mix_value(kRadius[i - 1], kRadius[i], (t - kAt[i - 1]) / (kAt[i] - kAt[i - 1])) + grow;
        };
        float field = 1e3f;
        for (std::size_t i = 1; i < kAt.size(); ++i) {
            const float a = std::max(kAt[i - 1], from), b = std::min(kAt[i], to);
            if (a < b)
                field =
                    blend(field, round_cone(p, arm_point(side, a), arm_point(side, b), radius(a), radius(b)), 0.015f);
        }
        return field;
    }
    [[nodiscard]] float hand(const Vector3f& world, int side) const {
        const Vector3f p = bind[static_cast<std::size_t>(upper_arm(side)) + 2].inverse() * world / h;
        const float s = sign(side);
        float field = ellipsoid(p, {0, 0, -0.028f}, {0.0235f, 0.0105f, 0.034f});
        field = blend(field, round_cone(p, {0, 0, 0.01f}, {0, 0, -0.012f}, 0.0155f * limb, 0.014f), 0.012f);
        for (int i = 0; i < 4; ++i) {
            const float x = -0.0165f + 0.0110f * static_cast<float>(i), length = i == 0   ? 0.082f
                                                                                 : i == 2 ? 0.100f
                                                                                          : 0.094f;
            const Vector3f knuckle(x, 0, -0.052f), middle(1.05f * x, -s * 0.004f, -0.5f * (0.052f + length)),
                tip(x, -s * 0.014f, -length);
            field = blend(field, round_cone(p, knuckle, middle, 0.0062f, 0.0056f), 0.004f);
            field = blend(field, round_cone(p, middle, tip, 0.0056f, 0.0046f), 0.003f);
        }
        field = blend(field,
                      round_cone(p, {0.017f, -s * 0.003f, -0.016f}, {0.030f, -s * 0.010f, -0.050f}, 0.0085f, 0.0060f),
                      0.006f);
        return field * h;
    }
    [[nodiscard]] float leg(const Vector3f& p, int side, float grow) const {
        const int b = thigh(side);
        const Vector3f hip = joint(b), knee = joint(b + 1), ankle = joint(b + 2);
        const Vector3f hem = ankle + Vector3f(0, 0, 0.002f * h);
        const float r = h * std::sqrt(g);
        float field = round_cone(p, hip - Vector3f(0, 0, 0.02f * h), knee, 0.047f * r + grow, 0.034f * r + grow);
        field =
            blend(field, round_cone(p, knee, hem + 0.55f * (knee - hem), 0.034f * r + grow, 0.033f * r + grow), 0.02f);
        field = blend(
            field, round_cone(p, hem + 0.55f * (knee - hem), hem, 0.033f * r + grow, 0.026f * r + 1.3f * grow), 0.02f);
        return carve(field, p.z() - 0.030f * h, 0.008f);
    }
    [[nodiscard]] Vector3f on_head(const Vector3f& p) const { return (p - joint(Head)) / h; }

    [[nodiscard]] float head(const Vector3f& world) const {
        const Vector3f q = on_head(world);
        const Vector3f p(q.x(), std::abs(q.y()), q.z());
        const float jaw = look.woman ? 0.033f : 0.0365f;
        float field = ellipsoid(p, {-0.004f, 0, 0.062f}, {0.0560f, 0.0440f, 0.0550f});
        field = blend(field, ellipsoid(p, {0.018f, 0, 0.022f}, {0.039f, jaw, 0.038f}), 0.022f);
        field = blend(field, ellipsoid(p, {0.046f, 0, -0.006f}, {0.012f, 0.014f, 0.011f}), 0.014f);      // chin
        field = blend(field, ellipsoid(p, {0.040f, 0.024f, 0.030f}, {0.013f, 0.011f, 0.010f}), 0.016f);  // cheek
        field = carve(field, ellipsoid(p, {0.0605f, 0.018f, 0.0475f}, {0.0085f, 0.0120f, 0.0070f}), 0.008f);
        field = blend(field, ellipsoid(p, {0.0440f, 0.018f, 0.0475f}, {0.0095f, 0.0100f, 0.0080f}), 0.002f);  // eyeball
        field = blend(field, round_cone(p, {0.0525f, 0, 0.050f}, {0.0640f, 0, 0.0275f}, 0.0050f, 0.0078f), 0.010f);
        field =
            blend(field, ellipsoid(p, {0.058f, 0.0065f, 0.0245f}, {0.007f, 0.0055f, 0.0045f}), 0.005f);  // nose wing
        field = blend(field, ellipsoid(p, {0.0525f, 0, 0.006f}, {0.0055f, 0.0150f, 0.0055f}), 0.007f);   // lips
        field = blend(field, ellipsoid(p, {-0.003f, 0.0445f, 0.037f}, {0.0125f, 0.0048f, 0.0185f}), 0.004f);  // ear
        const float neck = (look.woman ? 0.029f : 0.034f);
        field = blend(field, round_cone(p, {-0.014f, 0, -0.075f}, {-0.006f, 0, 0.015f}, 1.10f * neck, neck), 0.020f);
        field = blend(field, ellipsoid(p, {-0.008f, 0, -0.083f}, {0.036f, 0.060f, 0.018f}), 0.03f);  // collarbones
        return field * h;
    }
    [[nodiscard]] float hair(const Vector3f& world) const {
        const Vector3f q = on_head(world);
        const Vector3f p(q.x(), std::abs(q.y()), q.z());
        float field = ellipsoid(p, {-0.006f, 0, 0.063f}, {0.0610f, 0.0490f, 0.0600f});
        const float hairline = 0.5f * (0.044f + 0.92f * p.x() - p.z() + 0.25f * (p.y() - 0.03f));
        field = carve(field, -hairline, 0.006f);
        if (look.hair == Hair::Short) {
            field = blend(field,
                          carve(ellipsoid(p, {-0.020f, 0, 0.030f}, {0.040f, 0.0455f, 0.042f}),
                                p.z() - 0.004f + 0.3f * p.x(), 0.01f) +
                              (p.x() > 0 ? p.x() : 0),
                          0.006f);
        } else {
            field = blend(field, ellipsoid(p, {-0.026f, 0, 0.030f}, {0.040f, 0.050f, 0.050f}), 0.012f);
            field = carve(field, 0.022f - p.x() + 1.2f * std::max(p.z() - 0.070f, 0.0f), 0.004f);
        }
        if (look.hair == Hair::Long) {
            field = blend(field, ellipsoid(p, {-0.040f, 0, -0.010f}, {0.022f, 0.048f, 0.088f}), 0.015f);
            field = blend(field, round_cone(p, {-0.012f, 0.043f, 0.060f}, {-0.016f, 0.044f, -0.070f}, 0.012f, 0.011f),
                          0.012f);
        } else if (look.hair == Hair::Bun) {
            field = blend(field, ellipsoid(p, {-0.066f, 0, 0.072f}, {0.024f, 0.026f, 0.024f}), 0.006f);
        }
        const float strands = 0.0012f * std::sin(310 * q.y() + 90 * q.x()) * std::sin(60 * q.z() + 140 * q.x());
        return (field + strands) * h;
    }
    [[nodiscard]] float folds(const Vector3f& p, float amplitude) const {
        const auto s = static_cast<float>(look.seed % 1000);
        return amplitude * std::sin(38 * p.y() + 21 * p.z() + s) * std::sin(46 * p.z() - 17 * p.x() + 2 * s) +
               0.6f * amplitude * std::sin(71 * p.y() - 33 * p.z() + 3 * s);
    }
    [[nodiscard]] float sleeve_end() const { return look.long_sleeves ? 1.93f : 0.62f; }
    [[nodiscard]] float shirt(const Vector3f& p) const {
        // Loose over the hips, so that the trousers stay inside.
        const float hang = 0.010f + 0.012f * (1 - smoothstep(0.515f, 0.600f, p.z() / h));
        float field = trunk(p, look.woman ? 0.520f : 0.495f, 0.835f, hang);
        if (look.woman) {
            const Vector3f q(p.x(), std::abs(p.y()), p.z());
            field = blend(field,
                          ellipsoid(q, h * Vector3f(0.052f * g, 0.038f, 0.722f), h * Vector3f(0.034f, 0.036f, 0.038f)),
                          0.04f);
        }
        const float loose = look.long_sleeves ? 0.007f : 0.010f;
        for (const int side : {Left, Right}) {
            float sleeve = arm(p, side, 0, sleeve_end(), loose);
            const Vector3f end = arm_point(side, sleeve_end()), before = arm_point(side, sleeve_end() - 0.05f);
            sleeve = carve(sleeve, -(p - end).dot((end - before).normalized()), 0.004f);
            field = blend(field, sleeve, 0.045f);
        }
        return field + folds(p, 0.0022f);
    }
    [[nodiscard]] float trousers(const Vector3f& p) const {
        float field = trunk(p, 0.440f, 0.558f, 0.005f);
        field = blend(field, blend(leg(p, Left, 0.007f), leg(p, Right, 0.007f), 0.008f), 0.030f);
        return field + folds(p, 0.0018f);
    }
    [[nodiscard]] float shoe(const Vector3f& world, int side) const {
        const Vector3f p = bind[static_cast<std::size_t>(thigh(side)) + 2].inverse() * world / h;
        float field = ellipsoid(p, {-0.013f, 0, -0.026f}, {0.026f, 0.0205f, 0.024f});
        field = blend(field, round_cone(p, {0, 0, -0.008f}, {0.070f, 0, -0.031f}, 0.0215f, 0.0165f), 0.015f);
        field = blend(field, ellipsoid(p, {0.083f, 0, -0.033f}, {0.037f, 0.0245f, 0.0155f}), 0.015f);
        field = carve(field, p.z() + 0.0445f, 0.003f);
        return field * h;
    }
    /// The whole body, for ambient occlusion.
    [[nodiscard]] float everything(const Vector3f& p) const {
        float field = std::min({head(p), hair(p), shirt(p), trousers(p)});
        for (const int side : {Left, Right})
            field = std::min({field, hand(p, side), arm(p, side, 0.5f, 2, 0), shoe(p, side)});
        return field;
    }
};

// ---- skinning weights

/// Distance from a point of the bind pose to the part of the body that a bone moves.
float bone_distance(const Sculptor& s, const Vector3f& p, int bone) {
    const float h = s.h;
    const auto slab = [&](float low, float high) {
        const float side = s.trunk(p, -1, 2, 0);
        const float off = std::max({low * h - p.z(), p.z() - high * h, 0.0f});
        return std::hypot(std::max(side, 0.0f), off) + std::min(side, 0.0f);
    };
    const auto capsule = [&](int from, const Vector3f& to, float ra, float rb) {
        return round_cone(p, s.joint(from), to, ra * h, rb * h);
    };
    const float spine = s.size.spine_height / h, chest = s.size.chest_height / h;
    switch (bone) {
        case Pelvis:
            return slab(0.45f, spine);
        case Spine:
            return slab(spine, chest);
        case Chest:
            return slab(chest, 0.825f);
        case NeckBone:
            return capsule(NeckBone, s.joint(Head), 0.034f, 0.030f);
        case Head:
            return ellipsoid(p, s.joint(Head) + h * Vector3f(0.004f, 0, 0.052f), h * Vector3f(0.06f, 0.045f, 0.064f));
        case UpperArmL:
        case UpperArmR:
            return capsule(bone, s.joint(bone + 1), 0.028f, 0.023f);
        case ForearmL:
        case ForearmR:
            return capsule(bone, s.joint(bone + 1), 0.023f, 0.016f);
        case HandL:
        case HandR:
            return capsule(bone, s.bind[static_cast<std::size_t>(bone)] * Vector3f(0, 0, -0.10f * h), 0.016f, 0.012f);
        case ThighL:
        case ThighR:
            return capsule(bone, s.joint(bone + 1), 0.048f, 0.034f);
        case ShinL:
        case ShinR:
            return capsule(bone, s.joint(bone + 1), 0.034f, 0.022f);
        case FootL:
        case FootR:
            return capsule(bone, s.joint(bone + 1) + Vector3f(0, 0, 0.01f * h), 0.020f, 0.018f);
        default:
            return capsule(bone, s.joint(bone) + Vector3f(0.03f * h, 0, 0.01f * h), 0.018f, 0.015f);
    }
}

void bind_vertex(const Sculptor& s, BodyVertex& vertex) {
    std::array<std::pair<float, int>, kBoneCount> near;
    for (int b = 0; b < kBoneCount; ++b) near[static_cast<std::size_t>(b)] = {bone_distance(s, vertex.rest, b), b};
    std::partial_sort(near.begin(), near.begin() + 4, near.end());
    const float softness = 0.012f * s.h;  // joints bend over about 8 cm
    float total = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        vertex.bones[i] = static_cast<std::uint8_t>(near[i].second);
        vertex.weights[i] = std::exp((near[0].first - near[i].first) / softness);
        total += vertex.weights[i];
    }
    for (float& w : vertex.weights) w /= total;
}

/// Ambient occlusion from the distance field (Evans 2006): how far the field falls short of the distance walked.
float openness(const Sculptor& s, const BodyVertex& vertex) {
    float lack = 0, weight = 1;
    for (const float step : {0.015f, 0.04f, 0.08f, 0.14f}) {
        lack += weight * std::clamp((step - s.everything(vertex.rest + step * vertex.rest_normal)) / step, 0.0f, 1.0f);
        weight *= 0.7f;
    }
    return std::clamp(1.0f - 0.42f * lack, 0.25f, 1.0f);
}

void add_layer(Body& body, const Sculptor& sculptor, Layer layer, const DistanceField& field, const Vector3f& low,
               const Vector3f& high, float cell) {
    const Surface surface = surface_nets(field, low, high, cell);
    const auto first = static_cast<std::uint32_t>(body.vertices.size());
    for (std::size_t i = 0; i < surface.positions.size(); ++i) {
        BodyVertex vertex;
        vertex.rest = surface.positions[i];
        vertex.rest_normal = surface.normals[i];
        vertex.openness = openness(sculptor, vertex);
        bind_vertex(sculptor, vertex);
        if (layer == Layer::Hair) vertex.bones = {Head, 0, 0, 0}, vertex.weights = {1, 0, 0, 0};
        body.vertices.push_back(vertex);
    }
    for (const Triangle& t : surface.triangles) {
        body.triangles.push_back({first + t[0], first + t[1], first + t[2]});
        body.layers.push_back(layer);
    }
}

}  // namespace

Body make_body(const BodyLook& look) {
    const Proportions proportions(look.height, look.woman);
    Body body{look, proportions, bind_pose(proportions), {}, {}, {}};
    const BoneTransforms& bind = body.bind;
    const Sculptor s{look, proportions, bind};
    const float h = look.height;
    const auto box = [&](float x0, float y0, float z0, float x1, float y1, float z1) {
        return std::pair<Vector3f, Vector3f>(h * Vector3f(x0, y0, z0), h * Vector3f(x1, y1, z1));
    };
    const auto add = [&](Layer layer, const std::pair<Vector3f, Vector3f>& bounds, float cell,
                         const DistanceField& field) {
        add_layer(body, s, layer, field, bounds.first, bounds.second, cell);
    };
    add(Layer::Head, box(-0.08f, -0.08f, 0.79f, 0.09f, 0.08f, 1.02f), 0.0055f,
        [&](const Vector3f& p) { return s.head(p); });
    add(Layer::Hair, box(-0.11f, -0.08f, 0.75f, 0.09f, 0.08f, 1.03f), 0.0080f,
        [&](const Vector3f& p) { return s.hair(p); });
    add(Layer::Shirt, box(-0.13f, -0.40f, 0.46f, 0.14f, 0.40f, 0.87f), 0.0120f,
        [&](const Vector3f& p) { return s.shirt(p); });
    add(Layer::Trousers, box(-0.13f, -0.17f, 0.02f, 0.13f, 0.17f, 0.58f), 0.0120f,
        [&](const Vector3f& p) { return s.trousers(p); });
    for (const int side : {Left, Right}) {
        const float from = look.long_sleeves ? 1.7f : 0.4f;
        const Vector3f a = s.arm_point(side, from),
                       b = bind[static_cast<std::size_t>(upper_arm(side)) + 2] * Vector3f(0, 0, -0.12f * h);
        const Vector3f margin = Vector3f::Constant(0.045f * h);
        add(Layer::Arms, {a.cwiseMin(b) - margin, a.cwiseMax(b) + margin}, 0.0065f,
            [&](const Vector3f& p) { return blend(s.arm(p, side, from, 2, 0), s.hand(p, side), 0.01f); });
        const Vector3f ankle = s.joint(thigh(side) + 2);
        add(Layer::Shoes, {ankle + h * Vector3f(-0.06f, -0.04f, -0.055f), ankle + h * Vector3f(0.14f, 0.04f, 0.03f)},
            0.0080f, [&](const Vector3f& p) { return s.shoe(p, side); });
    }
    return body;
}

PosedBody pose_body(const Body& body, const BoneTransforms& bones) {
    std::array<Isometry3f, kBoneCount> skin;
    for (std::size_t b = 0; b < kBoneCount; ++b) skin[b] = bones[b] * body.bind[b].inverse();
    PosedBody posed;
    posed.positions.reserve(body.vertices.size());
    posed.normals.reserve(body.vertices.size());
    for (const BodyVertex& vertex : body.vertices) {
        Vector3f position = Vector3f::Zero(), normal = Vector3f::Zero();
        for (std::size_t i = 0; i < 4; ++i) {
            if (vertex.weights[i] <= 0) continue;
            const Isometry3f& t = skin[vertex.bones[i]];
            position += vertex.weights[i] * (t * vertex.rest);
            normal += vertex.weights[i] * (t.linear() * vertex.rest_normal);
        }
        posed.positions.push_back(position);
        posed.normals.push_back(normal.normalized());
    }
    return posed;
}

}  // namespace posefusion::synth
