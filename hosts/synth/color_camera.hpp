#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/core/image.hpp"
#include "hosts/synth/rolling_view.hpp"
#include "hosts/synth/scene.hpp"
#include "hosts/synth/sensor_unit.hpp"

namespace posefusion::synth {

/// Samples per pixel; with noise, each is taken at a different instant of the exposure.
inline constexpr int kColorSamples = 4;

/// Exposure settings.
struct Exposure {
    double seconds = 0.006;
    float grey_noise = 0.7f;  ///< standard deviation, grey levels of 255
};
inline constexpr Exposure kDaylight{};
inline constexpr Exposure kEvening{0.015, 1.4f};

/// Renders a colour image: 4 samples per pixel, lens blur and sensor noise, sRGB.
/// @param views     one per sample
/// @param gain      of linear light, per channel
/// @param exposure  none: neither blur nor noise
[[nodiscard]] ColorImage photograph(const Scene& scene, const Crowd& crowd, const SensorUnit& sensor,
                                    const std::vector<RollingView>& views, const Vector3f& gain,
                                    const std::optional<Exposure>& exposure, std::uint64_t seed, int threads);

}  // namespace posefusion::synth
