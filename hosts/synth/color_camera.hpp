#pragma once
#include <cstdint>
#include <vector>

#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "hosts/synth/scene.hpp"

namespace posefusion::synth {

/// Samples per pixel; with noise on each one is taken at a different instant of the exposure.
inline constexpr int kColorSamples = 4;
inline constexpr double kExposure = 0.006;  ///< seconds

/// Takes a colour picture: 4 samples per pixel, lens blur and sensor noise (noise on only), sRGB.
/// @param T_world_camera  one pose per sample
[[nodiscard]] ColorImage photograph(const Scene& scene, const Crowd& crowd, const Intrinsics& camera,
                                    const std::vector<Isometry3f>& T_world_camera, bool noise, std::uint64_t seed,
                                    int threads);

}  // namespace posefusion::synth
