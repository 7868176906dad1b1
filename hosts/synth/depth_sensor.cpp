#include "hosts/synth/depth_sensor.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/pinhole.hpp"
#include "hosts/synth/parallel.hpp"
#include "hosts/synth/random.hpp"

namespace posefusion::synth {
namespace {

constexpr float kSurfaceStart = 0.005f;  ///< shadow rays leave this far from the surface, metres

/// Zero mean, unit variance everywhere, correlated over about `spacing` pixels: white noise on a lattice, blended
/// bilinearly and scaled by what the blending takes away.
float correlated_noise(std::uint64_t seed, float u, float v, float spacing) {
    const float x = u / spacing, y = v / spacing, fx = std::floor(x), fy = std::floor(y), ax = x - fx, ay = y - fy;
    const auto at = [&](float dx, float dy) {
        return to_normal(hash(seed, static_cast<std::uint64_t>(static_cast<std::int64_t>(fx + dx)),
                              static_cast<std::uint64_t>(static_cast<std::int64_t>(fy + dy))));
    };
    const float wx[2] = {1 - ax, ax}, wy[2] = {1 - ay, ay};
    float sum = 0, squares = 0;
    for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
            const float w = wx[i] * wy[j];
            sum += w * at(static_cast<float>(i), static_cast<float>(j));
            squares += w * w;
        }
    return sum / std::sqrt(squares);
}

bool beside_edge(const DepthImage& depth, int u, int v, float jump) {
    const float z = depth(u, v);
    for (const auto& [du, dv] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}})
        if (depth.contains(u + du, v + dv) && std::abs(depth(u + du, v + dv) - z) > jump * z) return true;
    return false;
}

struct Sensor {
    const DepthSensorModel& model;
    const ExactView& exact;
    const Scene& scene;
    const Crowd& crowd;
    const Intrinsics& camera;
    const Isometry3f& pose;
    std::uint64_t seed;
    float scale = static_cast<float>(camera.width) / static_cast<float>(model.reference_width);

    [[nodiscard]] float measure(int u, int v) const {
        const auto x = static_cast<float>(u), y = static_cast<float>(v);
        const std::uint64_t pixel = hash(seed, static_cast<std::uint64_t>(u), static_cast<std::uint64_t>(v));
        const float lattice = std::max(model.lateral_correlation * scale, 1.0f), shift = model.lateral_sigma * scale;
        const Vector3f ray = pixel_ray(x + shift * correlated_noise(hash(seed, 1), x, y, lattice),
                                       y + shift * correlated_noise(hash(seed, 2), x, y, lattice), camera);
        const Vector3f direction = pose.linear() * ray, origin = pose.translation();
        const SceneHit found = scene.trace(crowd, origin, direction);
        const float z = found.hit.t;  // the ray's third component is 1 in the camera frame
        if (!found.any || z < model.nearest || z > model.farthest) return 0;
        if (beside_edge(exact.depth, u, v, model.edge_jump) && to_uniform(pixel) < model.edge_dropout) return 0;
        const Vector3f normal = scene.face_normal(crowd, found, direction);
        const float grazing = std::abs(normal.dot(direction)) / direction.norm();
        const float lost =
            1 - smoothstep(std::sin(model.grazing_none * kPi / 180), std::sin(model.grazing_full * kPi / 180), grazing);
        if (to_uniform(mix(pixel)) < lost) return 0;
        const Vector3f point = origin + z * direction + kSurfaceStart * normal;
        const Vector3f projector = pose * Vector3f(model.baseline, 0, 0);
        if (scene.occluded(crowd, point, projector - point, 0.0f, 1.0f)) return 0;
        const float noisy =
            z + model.axial.sigma(z) *
                    correlated_noise(hash(seed, 3), x, y, std::max(model.axial_correlation * scale, 1.0f));
        const float disparity = model.disparity_focal * model.baseline / noisy;
        const float quantised = std::round(disparity / model.disparity_step) * model.disparity_step;
        const float measured = model.disparity_focal * model.baseline / quantised;
        return measured < model.nearest || measured > model.farthest ? 0 : measured;
    }
};

}  // namespace

ExactView look_exactly(const Scene& scene, const Crowd& crowd, const Intrinsics& camera,
                       const Isometry3f& T_world_camera, int threads) {
    ExactView view{DepthImage(camera.width, camera.height), LabelImage(camera.width, camera.height)};
    parallel_for(camera.height, threads, [&](int v) {
        for (int u = 0; u < camera.width; ++u) {
            const Vector3f ray = pixel_ray(static_cast<float>(u), static_cast<float>(v), camera);
            const SceneHit found = scene.trace(crowd, T_world_camera.translation(), T_world_camera.linear() * ray);
            if (!found.any) continue;
            view.depth(u, v) = found.hit.t;
            view.labels(u, v) = static_cast<std::uint8_t>(found.person + 1);
        }
    });
    return view;
}

DepthImage measure_depth(const DepthSensorModel& model, const ExactView& exact, const Scene& scene, const Crowd& crowd,
                         const Intrinsics& camera, const Isometry3f& T_world_camera, std::uint64_t seed, int threads) {
    const Sensor sensor{model, exact, scene, crowd, camera, T_world_camera, seed};
    DepthImage depth(camera.width, camera.height);
    parallel_for(camera.height, threads, [&](int v) {
        for (int u = 0; u < camera.width; ++u) depth(u, v) = sensor.measure(u, v);
    });
    return depth;
}

}  // namespace posefusion::synth
