#include "hosts/synth/indirect_light.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/pinhole.hpp"
#include "hosts/synth/parallel.hpp"
#include "hosts/synth/random.hpp"

namespace posefusion::synth {
namespace {

constexpr int kBounces = 24;  ///< directions per point

/// Directions around a normal whose density grows with the cosine (Malley), spread by the golden angle.
Vector3f around(const Vector3f& normal, int i) {
    const float angle = 2.39996323f * static_cast<float>(i);
    const float radius2 = (static_cast<float>(i) + 0.5f) / kBounces, radius = std::sqrt(radius2);
    const Vector3f side = normal.unitOrthogonal();
    return radius * (std::cos(angle) * side + std::sin(angle) * normal.cross(side)) + std::sqrt(1 - radius2) * normal;
}

/// Whether the light beside the lens reaches a point in the camera's frame: it shines where the camera looks.
bool in_view(const Vector3f& point, const SensorUnit& sensor) {
    return point.z() > 0 && in_image(sensor.project(point), sensor.camera().intrinsics);
}

}  // namespace

IndirectLight::IndirectLight(float albedo, const DepthImage& exact, const SensorUnit& sensor, const Scene& scene,
                             const Crowd& crowd, const RollingView& view, int threads) {
    if (albedo <= 0) return;
    nodes_ = Image<Node>((exact.width() - 1) / kSpacing + 2, (exact.height() - 1) / kSpacing + 2);
    parallel_for(nodes_.height(), threads, [&](int j) {
        const int v = std::min(j * kSpacing, exact.height() - 1);
        const auto& [pose, moment] = view[static_cast<std::size_t>(v)];
        const Moment now(crowd, moment);
        const Vector3f origin = pose.translation();
        for (int i = 0; i < nodes_.width(); ++i) {
            const int u = std::min(i * kSpacing, exact.width() - 1);
            const Vector3f direction = pose.linear() * sensor.ray(static_cast<float>(u), static_cast<float>(v));
            const SceneHit found = scene.trace(now, origin, direction);
            if (!found.any) continue;
            const Vector3f normal = scene.face_normal(now, found, direction);
            const Vector3f point = origin + found.hit.t * direction + kSurfaceStart * normal;
            const float distance = found.hit.t * direction.norm();
            // Irradiance by the light beside the lens: direct, and by way of each other surface.
            const float direct = -normal.dot(direction) / direction.norm() / (distance * distance);
            float indirect = 0, detour = 0;
            for (int bounce = 0; bounce < kBounces; ++bounce) {
                const Vector3f way = around(normal, bounce);
                const SceneHit other = scene.trace(now, point, way);
                if (!other.any) continue;
                const Vector3f there_normal = scene.face_normal(now, other, way);
                const Vector3f there = point + other.hit.t * way + kSurfaceStart * there_normal;
                const Vector3f to_light = origin - there;
                const float far2 = to_light.squaredNorm(), far = std::sqrt(far2);
                const float lit = albedo / kBounces * there_normal.dot(to_light) / far / far2;
                if (lit <= 0 || !in_view(pose.inverse() * there, sensor) ||
                    scene.occluded(now, there, to_light, 0.0f, 1.0f))
                    continue;
                indirect += lit;
                detour += lit * 0.5f * std::max(far + other.hit.t - distance, 0.0f);  // there and back: half counts
            }
            nodes_(i, j) = {found.hit.t, 1 + detour / std::max(direct + indirect, 1e-6f) / distance};
        }
    });
}

float IndirectLight::lengthening(int u, int v, float z) const {
    if (nodes_.empty()) return 1;
    const int i = u / kSpacing, j = v / kSpacing;
    const float x = static_cast<float>(u) / kSpacing - static_cast<float>(i),
                y = static_cast<float>(v) / kSpacing - static_cast<float>(j);
    float sum = 0, weights = 0;
    for (const int dj : {0, 1})
        for (const int di : {0, 1}) {
            const Node& node = nodes_(i + di, j + dj);
            if (std::abs(node.depth - z) > kSameSurface * z) continue;
            const float weight = (di == 1 ? x : 1 - x) * (dj == 1 ? y : 1 - y);
            sum += weight * node.lengthening, weights += weight;
        }
    return weights > 0 ? sum / weights : 1;
}

}  // namespace posefusion::synth
