#pragma once
#include <cstdint>

#include "engine/core/image.hpp"
#include "hosts/synth/depth_sensor.hpp"

namespace posefusion::synth {

/// A dark cloth a few centimetres in front of the lens, pulled up from below: out of focus, with faint folds.
class Cover {
public:
    /// @param share  of the view that is covered, 0..1
    Cover(double share, std::uint64_t seed) : share_(static_cast<float>(share)), seed_(seed) {}

    [[nodiscard]] bool empty() const { return share_ <= 0; }
    void hide(ExactView& view) const;
    void darken(ColorImage& color) const;
    /// The sensor cannot measure so near: no value, except for a few wrong ones.
    void disturb(DepthImage& depth, const DepthSensorModel& sensor, std::uint64_t frame_seed) const;

private:
    /// Share of a pixel covered by the cloth, 0..1.
    [[nodiscard]] float at(int u, int v, int width, int height) const;
    float share_;
    std::uint64_t seed_;
};

}  // namespace posefusion::synth
