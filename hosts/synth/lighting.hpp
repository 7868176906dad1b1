#pragma once
#include <array>
#include <vector>

#include "hosts/synth/room.hpp"
#include "hosts/synth/tracer.hpp"

/// Diffuse light: lamp panels with soft shadows, and an ambient term darkened in corners.
namespace posefusion::synth {

inline constexpr std::size_t kMaxLamps = 4;  ///< in a room

/// Light that arrives at a point of the empty room.
struct BakedLight {
    float ambient = 0;
    std::array<float, kMaxLamps> lamps{};
};

/// Unoccluded irradiance from a lamp panel, approximated by a point light at its centre that shines downwards.
[[nodiscard]] float lamp_irradiance(const Lamp& lamp, const Vector3f& point, const Vector3f& normal);

/// Ambient light by the direction a surface faces: bright from the ceiling, warm and darker from the floor.
[[nodiscard]] float ambient_light(const Vector3f& normal);

/// One value per vertex of the room. Deterministic for any number of threads.
[[nodiscard]] std::vector<BakedLight> bake_light(const Room& room, const RayScene& scene, std::uint64_t seed,
                                                 int threads);

}  // namespace posefusion::synth
