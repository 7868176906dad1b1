#pragma once
#include <cstdint>
#include <vector>

#include "hosts/synth/rolling_view.hpp"
#include "hosts/synth/scene.hpp"
#include "hosts/synth/sensor_unit.hpp"

namespace posefusion::synth {

/// Brightness of a view as an exposure meter sees it: mean over the image, the middle counts more. Linear, 1 = white.
[[nodiscard]] float metered_brightness(const Scene& scene, const Moment& now, const SensorUnit& sensor,
                                       const Isometry3f& T_world_camera);

/// Gain of linear light of each frame: the control follows the brightness of the view with a lag.
class ExposureCourse {
public:
    /// @param brightness  metered, per frame; empty: the exposure does not follow it
    ExposureCourse(const ExposureControl& control, const std::vector<float>& brightness, double fps,
                   std::uint64_t seed);

    /// Of all channels, without the white balance: how much longer or shorter the exposure is than the first.
    [[nodiscard]] float gain(int frame) const;
    /// Per channel. RGB.
    [[nodiscard]] Vector3f channels(int frame) const;

private:
    ExposureControl control_;
    double fps_;
    std::vector<float> followed_ev_;  ///< per frame
    SmoothNoise wander_, balance_;
};

}  // namespace posefusion::synth
