#include "hosts/synth/depth_sensor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "hosts/synth/indirect_light.hpp"
#include "hosts/synth/parallel.hpp"
#include "hosts/synth/random.hpp"

namespace posefusion::synth {
namespace {

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

/// Standard deviation of the grey levels in the window of matching around each pixel.
Image<float> contrast_of(const ColorImage& color, int threads) {
    constexpr int kHalfWindow = 3;  // pixels
    Image<float> contrast(color.width(), color.height());
    parallel_for(color.height(), threads, [&](int v) {
        for (int u = 0; u < color.width(); ++u) {
            float sum = 0, squares = 0, count = 0;
            for (int y = std::max(v - kHalfWindow, 0); y <= std::min(v + kHalfWindow, color.height() - 1); ++y)
                for (int x = std::max(u - kHalfWindow, 0); x <= std::min(u + kHalfWindow, color.width() - 1); ++x) {
                    const auto grey = static_cast<float>(color(x, y).g);
                    sum += grey, squares += grey * grey, ++count;
                }
            contrast(u, v) = std::sqrt(std::max(squares / count - (sum / count) * (sum / count), 0.0f));
        }
    });
    return contrast;
}

/// Where light that a pixel of a time-of-flight sensor mixes comes from, in its pixels from the centre.
constexpr std::array<std::array<float, 2>, 4> kApertureOffsets{
    {{-0.125f, -0.375f}, {0.375f, -0.125f}, {0.125f, 0.375f}, {-0.375f, 0.125f}}};

struct Measurement {
    const SensorUnit& sensor;
    const ExactView& exact;
    const Image<float>& contrast;  ///< empty: does not matter
    const IndirectLight& indirect;
    const Scene& scene;
    const Crowd& crowd;
    const RollingView& view;
    std::uint64_t seed;
    const DepthSensorModel& model = sensor.model().depth;
    const Intrinsics& camera = sensor.camera().intrinsics;
    float scale = static_cast<float>(camera.width) / static_cast<float>(model.reference_width);

    /// Mean distance of what a pixel sees, by the light that comes back from it.
    [[nodiscard]] std::optional<float> mixed_depth(float x, float y, float pitch, const RowView& row) const {
        const Moment now(crowd, row.moment);
        float sum = 0, weights = 0;
        for (const auto& [du, dv] : kApertureOffsets) {
            const float reach = model.aperture * pitch;
            const Vector3f direction = row.T_world_camera.linear() * sensor.ray(x + reach * du, y + reach * dv);
            const SceneHit found = scene.trace(now, row.T_world_camera.translation(), direction);
            if (!found.any) continue;
            const float slant = std::abs(scene.face_normal(now, found, direction).dot(direction)) / direction.norm();
            const float weight = slant / (found.hit.t * found.hit.t);
            sum += weight * found.hit.t, weights += weight;
        }
        if (weights <= 0) return std::nullopt;
        return sum / weights;
    }

    [[nodiscard]] float measure(int column, int line) const {
        // The pixel of depth that this pixel of colour shows.
        const float pitch = model.columns > 0
                                ? std::max(static_cast<float>(camera.width) / static_cast<float>(model.columns), 1.0f)
                                : 1.0f;
        const auto u = static_cast<int>(static_cast<float>(column) / pitch),
                   v = static_cast<int>(static_cast<float>(line) / pitch);
        const float x = (static_cast<float>(u) + 0.5f) * pitch - 0.5f,
                    y = (static_cast<float>(v) + 0.5f) * pitch - 0.5f;
        const RowView& row = view[std::min(static_cast<std::size_t>(y + 0.5f), view.size() - 1)];
        const Moment now(crowd, row.moment);
        const Isometry3f& pose = row.T_world_camera;

        const std::uint64_t pixel = hash(seed, static_cast<std::uint64_t>(u), static_cast<std::uint64_t>(v));
        const float lattice = std::max(model.lateral_correlation * scale, 1.0f), shift = model.lateral_sigma * scale;
        const Vector3f ray = sensor.ray(x + shift * correlated_noise(hash(seed, 1), x, y, lattice),
                                        y + shift * correlated_noise(hash(seed, 2), x, y, lattice));
        const Vector3f direction = pose.linear() * ray, origin = pose.translation();
        const SceneHit found = scene.trace(now, origin, direction);
        float z = found.hit.t;  // the ray's third component is 1 in the camera frame
        if (!found.any || z < model.nearest || z > model.farthest) return 0;
        if (beside_edge(exact.depth, column, line, model.edge_jump) && to_uniform(pixel) < model.edge_dropout) return 0;
        const Vector3f normal = scene.face_normal(now, found, direction);
        const float grazing = std::abs(normal.dot(direction)) / direction.norm();
        const float lost =
            1 - smoothstep(std::sin(model.grazing_none * kPi / 180), std::sin(model.grazing_full * kPi / 180), grazing);
        if (to_uniform(mix(pixel)) < lost) return 0;
        if (in_shadow(now, pose, origin + z * direction + kSurfaceStart * normal)) return 0;
        const float weak = weakness(column, line);
        if (in_hole(x, y, weak)) return 0;

        if (model.aperture > 0) z = mixed_depth(x, y, pitch, row).value_or(z);
        z *= indirect.lengthening(column, line, z);
        z = sensor.depth_distortion().distorted(z, x, y, camera);
        const float noisy =
            z + mix_value(1, model.weak_noise, weak) * model.axial.sigma(z) *
                    correlated_noise(hash(seed, 3), x, y, std::max(model.axial_correlation * scale, 1.0f));
        const float measured = quantised(noisy);
        return measured < model.nearest || measured > model.farthest ? 0 : measured;
    }

    /// Whether the projector, or the second camera of stereo, does not see a point.
    [[nodiscard]] bool in_shadow(const Moment& now, const Isometry3f& pose, const Vector3f& point) const {
        if (model.baseline == 0) return false;
        const Vector3f projector = pose * Vector3f(model.baseline, 0, 0);
        return scene.occluded(now, point, projector - point, 0.0f, 1.0f);
    }
    /// 1 where there is nothing to match, 0 where there is enough.
    [[nodiscard]] float weakness(int u, int v) const {
        return contrast.empty() ? 0.0f : 1 - smoothstep(0, model.weak_contrast, contrast(u, v));
    }
    [[nodiscard]] bool in_hole(float x, float y, float weak) const {
        if (!std::isfinite(model.hole_sigmas)) return false;
        const float field = correlated_noise(hash(seed, 4), x, y, std::max(model.hole_size * scale, 1.0f));
        return field > mix_value(model.hole_sigmas, model.weak_hole_sigmas, weak);
    }
    [[nodiscard]] float quantised(float z) const {
        if (model.disparity_step == 0) return z;
        const float disparity = model.disparity_focal * model.baseline / z;
        const float whole = std::round(disparity / model.disparity_step) * model.disparity_step;
        return model.disparity_focal * model.baseline / whole;
    }
};

}  // namespace

ExactView look_exactly(const Scene& scene, const Crowd& crowd, const SensorUnit& sensor, const RollingView& rows,
                       int threads) {
    const Intrinsics& camera = sensor.camera().intrinsics;
    ExactView view{DepthImage(camera.width, camera.height), LabelImage(camera.width, camera.height)};
    parallel_for(camera.height, threads, [&](int v) {
        const auto& [T_world_camera, moment] = rows[static_cast<std::size_t>(v)];
        const Moment now(crowd, moment);
        for (int u = 0; u < camera.width; ++u) {
            const Vector3f ray = sensor.ray(static_cast<float>(u), static_cast<float>(v));
            const SceneHit found = scene.trace(now, T_world_camera.translation(), T_world_camera.linear() * ray);
            if (!found.any) continue;
            view.depth(u, v) = found.hit.t;
            if (found.part >= 0) view.labels(u, v) = static_cast<std::uint8_t>(crowd.label_of(found.part));
        }
    });
    return view;
}

DepthImage measure_depth(const SensorUnit& sensor, const ExactView& exact, const ColorImage& color, const Scene& scene,
                         const Crowd& crowd, const RollingView& view, std::uint64_t seed, int threads) {
    const DepthSensorModel& model = sensor.model().depth;
    const Image<float> contrast = model.weak_contrast > 0 ? contrast_of(color, threads) : Image<float>{};
    const IndirectLight indirect(model.indirect_albedo, exact.depth, sensor, scene, crowd, view, threads);
    const Measurement measurement{sensor, exact, contrast, indirect, scene, crowd, view, seed};
    DepthImage depth(exact.depth.width(), exact.depth.height());
    parallel_for(depth.height(), threads, [&](int v) {
        for (int u = 0; u < depth.width(); ++u) depth(u, v) = measurement.measure(u, v);
    });
    return depth;
}

void distort_depth(const SensorUnit& sensor, DepthImage& depth) {
    for (int v = 0; v < depth.height(); ++v)
        for (int u = 0; u < depth.width(); ++u)
            depth(u, v) = sensor.depth_distortion().distorted(depth(u, v), static_cast<float>(u), static_cast<float>(v),
                                                              sensor.camera().intrinsics);
}

}  // namespace posefusion::synth
