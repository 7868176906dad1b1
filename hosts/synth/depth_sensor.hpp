#pragma once
#include <cstdint>

#include "engine/core/image.hpp"
#include "hosts/synth/rolling_view.hpp"
#include "hosts/synth/scene.hpp"
#include "hosts/synth/sensor_unit.hpp"

namespace posefusion::synth {

/// The exact depth and labels at the pixel centres.
struct ExactView {
    DepthImage depth;   ///< metres, 0 = nothing
    LabelImage labels;  ///< 0 = room, i + 1 = person i, Mover::label
};

[[nodiscard]] ExactView look_exactly(const Scene& scene, const Crowd& crowd, const SensorUnit& sensor,
                                     const RollingView& view, int threads);

/// Simulates the sensor's measurement of an exact depth image.
/// @param color  of the same frame: what stereo has to match
[[nodiscard]] DepthImage measure_depth(const SensorUnit& sensor, const ExactView& exact, const ColorImage& color,
                                       const Scene& scene, const Crowd& crowd, const RollingView& view,
                                       std::uint64_t seed, int threads);

/// Applies the smooth error of the sensor's depth alone.
void distort_depth(const SensorUnit& sensor, DepthImage& depth);

}  // namespace posefusion::synth
