#pragma once
#include "engine/core/image.hpp"
#include "hosts/synth/rolling_view.hpp"
#include "hosts/synth/scene.hpp"
#include "hosts/synth/sensor_unit.hpp"

namespace posefusion::synth {

/// Multipath of a time-of-flight sensor: part of the light reaches a surface by way of another one, later, and the
/// sensor sees the mean. Corners recede and look round. One bounce between diffuse surfaces; the phase is taken as
/// linear, which it is for detours much shorter than the wavelength of the modulation.
class IndirectLight {
public:
    /// @param albedo  of all surfaces in the infra-red; 0: there is no indirect light
    IndirectLight(float albedo, const DepthImage& exact, const SensorUnit& sensor, const Scene& scene,
                  const Crowd& crowd, const RollingView& view, int threads);

    /// Measured over true distance, >= 1, at a pixel. @param z  its depth, metres
    [[nodiscard]] float lengthening(int u, int v, float z) const;

private:
    static constexpr int kSpacing = 4;           ///< pixels between the points where it is computed
    static constexpr float kSameSurface = 0.1f;  ///< relative difference of depth
    struct Node {
        float depth = 0, lengthening = 1;
    };
    Image<Node> nodes_;  ///< empty: there is no indirect light
};

}  // namespace posefusion::synth
