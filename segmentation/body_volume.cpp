#include "segmentation/body_volume.hpp"

#include <algorithm>
#include <array>
#include <limits>

#include "engine/core/pinhole.hpp"

namespace posefusion {
namespace {

using Eigen::Vector3f;

struct Bone {
    int from, to;
    float radius;  ///< metres, light clothing included
};
constexpr std::array<Bone, 15> kBones{{
    {RightShoulder, RightElbow, 0.065f},
    {RightElbow, RightWrist, 0.055f},
    {LeftShoulder, LeftElbow, 0.065f},
    {LeftElbow, LeftWrist, 0.055f},
    {RightHip, RightKnee, 0.095f},
    {RightKnee, RightAnkle, 0.07f},
    {LeftHip, LeftKnee, 0.095f},
    {LeftKnee, LeftAnkle, 0.07f},
    {RightShoulder, LeftShoulder, 0.075f},
    {RightHip, LeftHip, 0.12f},
    {RightShoulder, RightHip, 0.09f},
    {LeftShoulder, LeftHip, 0.09f},
    {Neck, RightHip, 0.13f},
    {Neck, LeftHip, 0.13f},
    {RightShoulder, LeftHip, 0.12f},
}};
constexpr float kHeadRadius = 0.12f;
constexpr float kNeckRadius = 0.08f;
constexpr float kHandLength = 0.17f, kHandRadius = 0.055f;
constexpr float kHeelLength = 0.07f, kHeelRadius = 0.06f;
constexpr float kFootReach = 0.20f;
constexpr float kHairReach = 0.17f, kHairLength = 0.05f;
constexpr float kNeckToHead = 0.22f;

float distance_to_axis(const Vector3f& p, const Capsule& c) {
    const Vector3f axis = c.b - c.a;
    const float length2 = axis.squaredNorm();
    const float t = length2 > 0 ? std::clamp((p - c.a).dot(axis) / length2, 0.0f, 1.0f) : 0.0f;
    return (p - c.a - t * axis).norm();
}

float union_distance(const Vector3f& p, const std::vector<Capsule>& capsules) {
    float nearest = std::numeric_limits<float>::max();
    for (const Capsule& c : capsules) nearest = std::min(nearest, distance_to_axis(p, c) - c.radius);
    return nearest;
}

/// `to`, moved by `length` in the direction from `from` to `to`.
Vector3f beyond(const Vector3f& from, const Vector3f& to, float length) {
    const Vector3f direction = to - from;
    const float norm = direction.norm();
    return norm > 1e-3f ? Vector3f(to + direction * (length / norm)) : to;
}

void add_head(const Skeleton& s, std::vector<Capsule>& body, std::vector<Capsule>& ends, std::vector<Capsule>& reach) {
    Vector3f sum = Vector3f::Zero();
    int count = 0;
    const auto take = [&](int j) {
        if (s.has(j)) sum += s.joint[j], ++count;
    };
    if (s.has(RightEar) && s.has(LeftEar)) {
        take(RightEar), take(LeftEar);
    } else {
        for (const int j : {Nose, RightEye, LeftEye, RightEar, LeftEar}) take(j);
    }
    if (count > 0) {
        const Vector3f center = sum / static_cast<float>(count);
        body.push_back({center, center, kHeadRadius});
        ends.push_back({center, center, kHairReach});
        if (s.has(Neck)) {
            body.push_back({s.joint[Neck], center, kNeckRadius});
            ends.push_back({center, beyond(s.joint[Neck], center, kHairLength), kHairReach});
        }
    } else if (s.has(Neck)) {
        Vector3f up(0, -1, 0);
        for (const int hip : {RightHip, LeftHip})
            if (s.has(hip)) up = (s.joint[Neck] - s.joint[hip]).normalized();
        reach.push_back({s.joint[Neck], s.joint[Neck] + kNeckToHead * up, kHairReach});
    }
}

void add_ends(const Skeleton& s, std::vector<Capsule>& body, std::vector<Capsule>& ends, std::vector<Capsule>& reach) {
    for (const auto& [elbow, wrist] : {std::pair{RightElbow, RightWrist}, {LeftElbow, LeftWrist}}) {
        if (!s.has(wrist)) continue;
        if (s.has(elbow)) {
            const Vector3f tip = beyond(s.joint[elbow], s.joint[wrist], kHandLength);
            body.push_back({s.joint[wrist], tip, kHandRadius});
        }
        reach.push_back({s.joint[wrist], s.joint[wrist], kHandLength});
    }
    for (const auto& [knee, ankle] : {std::pair{RightKnee, RightAnkle}, {LeftKnee, LeftAnkle}}) {
        if (!s.has(ankle)) continue;
        if (s.has(knee)) {
            const Vector3f heel = beyond(s.joint[knee], s.joint[ankle], kHeelLength);
            body.push_back({s.joint[ankle], heel, kHeelRadius});
            ends.push_back({heel, heel, kFootReach});
        } else {
            ends.push_back({s.joint[ankle], s.joint[ankle], kFootReach});
        }
    }
}

/// A torso whose hips or neck were not found may lie on any side of the joints that were.
void add_missing_torso(const Skeleton& s, std::vector<Capsule>& reach) {
    const bool hips = s.has(RightHip) || s.has(LeftHip);
    const Vector3f down(0, 1, 0);
    if (s.has(Neck) && !hips) reach.push_back({s.joint[Neck], s.joint[Neck] + 0.7f * down, 0.45f});
    for (const int shoulder : {RightShoulder, LeftShoulder})
        if (s.has(shoulder) && !s.has(Neck))
            reach.push_back({s.joint[shoulder], s.joint[shoulder] + 0.6f * down, 0.60f});
    for (const int hip : {RightHip, LeftHip})
        if (s.has(hip) && !s.has(Neck)) reach.push_back({s.joint[hip], s.joint[hip] - 0.6f * down, 0.50f});
}

/// Limbs that the network did not find may be anywhere around the last joint that it found.
void add_missing_limbs(const Skeleton& s, std::vector<Capsule>& reach) {
    struct Chain {
        int root, middle, end;
        float radius;
    };
    for (const Chain& c : {Chain{RightShoulder, RightElbow, RightWrist, 0.45f},
                           {LeftShoulder, LeftElbow, LeftWrist, 0.45f},
                           {RightHip, RightKnee, RightAnkle, 0.50f},
                           {LeftHip, LeftKnee, LeftAnkle, 0.50f}}) {
        if (s.has(c.root) && !s.has(c.middle)) reach.push_back({s.joint[c.root], s.joint[c.root], c.radius});
        if (s.has(c.middle) && !s.has(c.end)) reach.push_back({s.joint[c.middle], s.joint[c.middle], c.radius * 0.8f});
    }
}

}  // namespace

BodyVolume::BodyVolume(const Skeleton& skeleton) {
    for (const Bone& bone : kBones)
        if (skeleton.has(bone.from) && skeleton.has(bone.to)) {
            body_.push_back({skeleton.joint[bone.from], skeleton.joint[bone.to], bone.radius});
            if (skeleton.source[bone.from] == JointSource::Measured &&
                skeleton.source[bone.to] == JointSource::Measured)
                seen_.push_back(body_.back());
        }
    for (int j = 0; j < kJointCount; ++j)
        if (skeleton.has(j)) body_.push_back({skeleton.joint[j], skeleton.joint[j], 0.05f});
    add_head(skeleton, body_, ends_, reach_);
    add_ends(skeleton, body_, ends_, reach_);
    add_missing_torso(skeleton, reach_);
    add_missing_limbs(skeleton, reach_);

    Vector3f low = Vector3f::Constant(std::numeric_limits<float>::max()), high = -low;
    const auto include = [&](const Capsule& c) {
        const Vector3f r = Vector3f::Constant(c.radius);
        low = low.cwiseMin(c.a - r).cwiseMin(c.b - r);
        high = high.cwiseMax(c.a + r).cwiseMax(c.b + r);
    };
    for (const Capsule& c : body_) include(c);
    for (const Capsule& c : ends_) include(c);
    for (const Capsule& c : reach_) include(c);
    center_ = 0.5f * (low + high);
    extent_ = 0.5f * (high - low).norm();
}

float BodyVolume::distance(const Vector3f& point) const { return union_distance(point, body_); }

float BodyVolume::seen_distance(const Vector3f& point) const { return union_distance(point, seen_); }

float BodyVolume::ends_distance(const Vector3f& point) const { return union_distance(point, ends_); }

float BodyVolume::reach_distance(const Vector3f& point) const { return union_distance(point, reach_); }

float BodyVolume::outline_distance(float u, float v, const Intrinsics& camera) const {
    constexpr float kNearest = 0.1f;  // axes are clipped in front of the camera, metres
    float nearest = std::numeric_limits<float>::max();
    const Eigen::Vector2f p = pixel_ray(u, v, camera).head<2>();
    for (const Capsule& c : body_) {
        const float za = std::max(c.a.z(), kNearest), zb = std::max(c.b.z(), kNearest);
        const Eigen::Vector2f a = c.a.head<2>() / za, b = c.b.head<2>() / zb;
        const Eigen::Vector2f axis = b - a;
        const float length2 = axis.squaredNorm();
        const float t = length2 > 0 ? std::clamp((p - a).dot(axis) / length2, 0.0f, 1.0f) : 0.0f;
        const float z = za + t * (zb - za);
        nearest = std::min(nearest, (p - a - t * axis).norm() * z - c.radius);
    }
    return nearest;
}

}  // namespace posefusion
