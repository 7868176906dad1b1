#include "tests/segmentation/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "engine/core/depth_noise.hpp"
#include "engine/core/pinhole.hpp"

namespace posefusion::test {
namespace {

using Eigen::Vector3f;

struct Capsule {
    Vector3f a, b;
    float radius;
    std::uint8_t person;
};

std::array<Vector3f, kJointCount> joints_of(const Mannequin& m) {
    const auto at = [&](float x, float y, float z) { return Vector3f(m.x + x, y, m.z + z); };
    std::array<Vector3f, kJointCount> j;
    j[Nose] = at(0, -0.24f, -0.10f);
    j[Neck] = at(0, -0.03f, 0);
    for (const auto& [side, shoulder, hip, eye, ear] : {std::array{-1, +RightShoulder, +RightHip, +RightEye, +RightEar},
                                                        std::array{1, +LeftShoulder, +LeftHip, +LeftEye, +LeftEar}}) {
        const auto s = static_cast<float>(side);
        j[shoulder] = at(0.19f * s, -0.02f, 0);
        j[shoulder + 1] = at(0.27f * s, 0.26f, 0.02f);
        j[shoulder + 2] = at(0.31f * s, 0.50f, -0.05f);
        j[hip] = at(0.10f * s, 0.48f, 0);
        j[hip + 1] = at(0.11f * s, 0.92f, -0.03f);
        j[hip + 2] = at(0.11f * s, 1.32f, 0.02f);
        j[eye] = at(0.03f * s, -0.28f, -0.09f);
        j[ear] = at(0.075f * s, -0.27f, 0);
    }
    return j;
}

std::vector<Capsule> body_of(const Mannequin& m, std::uint8_t person) {
    const auto j = joints_of(m);
    const Vector3f head(m.x, -0.27f, m.z);
    std::vector<Capsule> body{{head, head + Vector3f(0, -0.02f, 0), 0.11f, person}, {j[Neck], head, 0.06f, person}};
    const auto add = [&](int a, int b, float radius) { body.push_back({j[a], j[b], radius, person}); };
    add(RightShoulder, LeftShoulder, 0.08f), add(RightHip, LeftHip, 0.12f);
    add(RightShoulder, RightHip, 0.09f), add(LeftShoulder, LeftHip, 0.09f);
    add(Neck, RightHip, 0.12f), add(Neck, LeftHip, 0.12f);
    for (const int s : {RightShoulder, LeftShoulder}) add(s, s + 1, 0.055f), add(s + 1, s + 2, 0.045f);
    for (const int h : {RightHip, LeftHip}) add(h, h + 1, 0.085f), add(h + 1, h + 2, 0.06f);
    for (const int w : {RightWrist, LeftWrist})
        body.push_back({j[w], j[w] + Vector3f(0, 0.14f, -0.02f), 0.04f, person});
    for (const int a : {RightAnkle, LeftAnkle})
        body.push_back({j[a] + Vector3f(0, 0.03f, 0), j[a] + Vector3f(0, 0.035f, -0.16f), 0.045f, person});
    return body;
}

float distance(const Vector3f& p, const Capsule& c) {
    const Vector3f axis = c.b - c.a;
    const float length2 = axis.squaredNorm();
    const float t = length2 > 0 ? std::clamp((p - c.a).dot(axis) / length2, 0.0f, 1.0f) : 0.0f;
    return (p - c.a - t * axis).norm() - c.radius;
}

/// Depth along `ray` (z = 1) at which the box is entered, 0 = missed.
float enter(const Box& box, const Vector3f& origin, const Vector3f& ray) {
    float near = 0, far = 1e9f;
    for (int k = 0; k < 3; ++k) {
        if (std::abs(ray[k]) < 1e-9f) {
            if (origin[k] < box.low[k] || origin[k] > box.high[k]) return 0;
            continue;
        }
        const float t0 = (box.low[k] - origin[k]) / ray[k], t1 = (box.high[k] - origin[k]) / ray[k];
        near = std::max(near, std::min(t0, t1));
        far = std::min(far, std::max(t0, t1));
    }
    return near > 0 && near < far ? near : 0;
}

struct Hit {
    float z;
    Part part;
    std::uint8_t person = 0;
};

Hit trace(const std::vector<Capsule>& capsules, const std::vector<Box>& boxes, const Vector3f& origin,
          const Vector3f& ray) {
    Hit hit{kWall - origin.z(), kWallPart};
    if (ray.y() > 0) {
        const float z = (kFloor - origin.y()) / ray.y();
        if (z < hit.z) hit = {z, kFloorPart};
    }
    for (const Box& box : boxes)
        if (const float z = enter(box, origin, ray); z > 0 && z < hit.z) hit = {z, kBoxPart};
    const float stretch = ray.norm();
    float z = 0.4f;
    for (int i = 0; i < 64 && z < hit.z; ++i) {  // sphere tracing
        float nearest = 1e9f;
        std::uint8_t person = 0;
        for (const Capsule& c : capsules)
            if (const float d = distance(origin + z * ray, c); d < nearest) nearest = d, person = c.person;
        if (nearest < 1e-3f) return {z, kPersonPart, person};
        z += nearest / stretch;
    }
    return hit;
}

Rgb8 paint(const Hit& hit, int u, int v) {
    const auto grain = static_cast<std::uint8_t>((u * 7 + v * 13) % 8);
    const auto shade = [&](int r, int g, int b) {
        return Rgb8{static_cast<std::uint8_t>(r + grain), static_cast<std::uint8_t>(g + grain),
                    static_cast<std::uint8_t>(b + grain)};
    };
    switch (hit.part) {
        case kWallPart:
            return shade(190, 190, 185);
        case kFloorPart:
            return shade(130, 100, 70);
        case kBoxPart:
            return shade(40, 60, 130);
        case kPersonPart:
            break;
    }
    return hit.person % 2 ? shade(160, 40, 40) : shade(40, 130, 60);
}

}  // namespace

Intrinsics camera_of(int width, int height) {
    const float f = 525.0f * static_cast<float>(width) / 640.0f;
    return {f, f, 0.5f * static_cast<float>(width - 1), 0.5f * static_cast<float>(height - 1), width, height};
}

Frame render(const Scene& scene, const Intrinsics& camera) {
    std::vector<Capsule> capsules;
    for (std::size_t p = 0; p < scene.people.size(); ++p) {
        const auto body = body_of(scene.people[p], static_cast<std::uint8_t>(p + 1));
        capsules.insert(capsules.end(), body.begin(), body.end());
    }
    std::mt19937 random(1);
    Frame frame{ColorImage(camera.width, camera.height),
                DepthImage(camera.width, camera.height),
                LabelImage(camera.width, camera.height),
                LabelImage(camera.width, camera.height),
                {}};
    for (int v = 0; v < camera.height; ++v)
        for (int u = 0; u < camera.width; ++u) {
            const Vector3f ray = pixel_ray(static_cast<float>(u), static_cast<float>(v), camera);
            const Hit hit = trace(capsules, scene.boxes, scene.camera, ray);
            const float sigma = DepthNoise{}.sigma(hit.z);
            const float noise = static_cast<float>(random() % 2001) / 1000.0f - 1.0f;
            frame.depth(u, v) = hit.z + 1.7f * sigma * noise;
            frame.color(u, v) = paint(hit, u, v);
            frame.truth(u, v) = hit.person;
            frame.parts(u, v) = hit.part;
        }
    for (const Mannequin& m : scene.people) {
        Person person;
        person.score = 1;
        person.box = {1e9f, 1e9f, -1e9f, -1e9f};
        const auto joints = joints_of(m);
        for (int j = 0; j < kJointCount; ++j) {
            const Eigen::Vector2f at = project(joints[j] - scene.camera, camera);
            if (!in_image(at, camera)) continue;
            const float u = at.x(), v = at.y();
            person.joints[j] = {u, v, 1};
            person.box = {std::min(person.box.u_min, u), std::min(person.box.v_min, v), std::max(person.box.u_max, u),
                          std::max(person.box.v_max, v)};
        }
        if (!person.box.empty()) frame.people.push_back(person);
    }
    return frame;
}

Score score(const LabelImage& labels, const LabelImage& truth) {
    double hit = 0, missed = 0, lost = 0, clear = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (truth[i])
            ++(labels[i] ? hit : missed);
        else
            ++(labels[i] ? lost : clear);
    }
    return {hit / std::max(hit + missed, 1.0), lost / std::max(lost + clear, 1.0),
            hit / std::max(hit + missed + lost, 1.0)};
}

double labelled_share(const LabelImage& labels, const LabelImage& parts, Part part) {
    double all = 0, labelled = 0;
    for (std::size_t i = 0; i < parts.size(); ++i)
        if (parts[i] == part) ++all, labelled += labels[i] > 0;
    return all > 0 ? labelled / all : 0;
}

}  // namespace posefusion::test
