#pragma once
#include <Eigen/Geometry>

#include "hosts/synth/random.hpp"

namespace posefusion::synth {

/// The hands that hold the camera: a slight tremor on top of its position and viewing direction.
class Hand {
public:
    explicit Hand(std::uint64_t seed);
    /// T_world_camera: camera x right, y down, z forward.
    /// @param forward  unit  @param roll about the line of sight, rad  @param t seconds
    [[nodiscard]] Eigen::Isometry3d hold(const Eigen::Vector3d& position, const Eigen::Vector3d& forward, double roll,
                                         double t) const;

private:
    SmoothNoise x_, y_, z_, pan_, tilt_, roll_;
};

}  // namespace posefusion::synth
