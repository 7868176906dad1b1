#include "hosts/synth/lighting.hpp"

#include <algorithm>
#include <cmath>

#include "hosts/synth/parallel.hpp"
#include "hosts/synth/random.hpp"

namespace posefusion::synth {
namespace {

constexpr int kLampRaysAcross = 3;       ///< shadow rays per lamp: a grid of this many by this many
constexpr int kSkyRays = 36;             ///< rays for ambient occlusion
constexpr float kOcclusionReach = 1.1f;  ///< metres: things farther away do not darken
constexpr float kLift = 0.004f;          ///< rays start this far off the surface, metres
constexpr float kInward =
    0.012f;  ///< and this far towards the middle of the room: corners lie in the next wall, metres

/// Cosine-weighted direction about a normal.
Vector3f around(const Vector3f& normal, float a, float b) {
    const Vector3f helper = std::abs(normal.z()) < 0.9f ? Vector3f::UnitZ() : Vector3f::UnitX();
    const Vector3f x = normal.cross(helper).normalized(), y = normal.cross(x);
    const float r = std::sqrt(a), angle = 2 * kPi * b;
    return r * std::cos(angle) * x + r * std::sin(angle) * y + std::sqrt(std::max(1 - a, 0.0f)) * normal;
}

float ambient_openness(const RayScene& scene, const Vector3f& from, const Vector3f& normal, std::uint64_t seed) {
    const int side = static_cast<int>(std::sqrt(static_cast<float>(kSkyRays)));
    float open = 0;
    for (int i = 0; i < side * side; ++i) {
        const std::uint64_t h = hash(seed, static_cast<std::uint64_t>(i));
        const int column = i % side, row = i / side;
        const float a = (static_cast<float>(column) + to_uniform(h)) / static_cast<float>(side);
        const float b = (static_cast<float>(row) + to_uniform(mix(h))) / static_cast<float>(side);
        Hit hit{kOcclusionReach, 0, 0, 0};
        open += scene.intersect(from, around(normal, a, b), 0.0f, hit)
                    ? 0.2f + 0.8f * std::sqrt(hit.t / kOcclusionReach)
                    : 1.0f;
    }
    return open / static_cast<float>(side * side);
}

float lamp_visibility(const RayScene& scene, const Lamp& lamp, const Vector3f& from) {
    int seen = 0;
    for (int i = 0; i < kLampRaysAcross; ++i)
        for (int j = 0; j < kLampRaysAcross; ++j) {
            const Vector2f cell = (Vector2f(static_cast<float>(i), static_cast<float>(j)) + Vector2f::Constant(0.5f)) *
                                      (2.0f / kLampRaysAcross) -
                                  Vector2f::Ones();
            const Vector2f offset = cell.cwiseProduct(lamp.half);
            const Vector3f to = lamp.center + Vector3f(offset.x(), offset.y(), 0) - from;
            seen += scene.occluded(from, to, 0.0f, 0.99f) ? 0 : 1;
        }
    return static_cast<float>(seen) / (kLampRaysAcross * kLampRaysAcross);
}

const Vector3f& nearest(const std::vector<Vector3f>& points, const Vector3f& p) {
    return *std::min_element(points.begin(), points.end(), [&](const Vector3f& a, const Vector3f& b) {
        return (a - p).squaredNorm() < (b - p).squaredNorm();
    });
}

}  // namespace

float lamp_irradiance(const Lamp& lamp, const Vector3f& point, const Vector3f& normal) {
    const Vector3f to = lamp.center - point;
    const float squared = to.squaredNorm();
    const Vector3f direction = to / std::sqrt(squared);
    // A panel is not a point: near it the light stays finite, and surfaces seen edge-on still get some.
    const float facing = std::max((normal.dot(direction) + 0.15f) / 1.15f, 0.0f);
    return lamp.power * facing * std::max(direction.z(), 0.0f) / (squared + 0.5f);
}

float ambient_light(const Vector3f& normal) { return 0.34f + 0.08f * normal.z(); }

std::vector<BakedLight> bake_light(const Room& room, const RayScene& scene, std::uint64_t seed, int threads) {
    std::vector<BakedLight> light(room.mesh.vertices.size());
    constexpr int kChunk = 256;
    const int count = static_cast<int>(light.size());
    parallel_for((count + kChunk - 1) / kChunk, threads, [&](int chunk) {
        for (int i = chunk * kChunk; i < std::min((chunk + 1) * kChunk, count); ++i) {
            const auto k = static_cast<std::size_t>(i);
            const RoomVertex& vertex = room.mesh.vertices[k];
            const Vector3f inward = (nearest(room.air, vertex.position) - vertex.position).normalized();
            const Vector3f from = vertex.position + kLift * vertex.normal + kInward * inward;
            light[k].ambient =
                ambient_light(vertex.normal) * ambient_openness(scene, from, vertex.normal, hash(seed, k));
            for (std::size_t l = 0; l < room.lamps.size(); ++l) {
                const float direct = lamp_irradiance(room.lamps[l], from, vertex.normal);
                light[k].lamps[l] = direct > 0 ? direct * lamp_visibility(scene, room.lamps[l], from) : 0.0f;
            }
        }
    });
    return light;
}

}  // namespace posefusion::synth
