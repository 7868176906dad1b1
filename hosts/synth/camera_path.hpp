#pragma once
#include <Eigen/Geometry>

#include "hosts/synth/hand.hpp"
#include "hosts/synth/random.hpp"
#include "hosts/synth/room.hpp"

namespace posefusion::synth {

/// A hand-held camera: it moves smoothly within the space kept free for it, looks around, and trembles a little.
class CameraPath {
public:
    /// @param pace  1 = about 0.2 m/s; 0 = the camera stays in place, only the tremor remains
    CameraPath(const Room& room, std::uint64_t seed, double pace);
    /// T_world_camera: camera x right, y down, z forward. Smooth in t (seconds).
    [[nodiscard]] Eigen::Isometry3d at(double t) const;

private:
    Eigen::Vector3d home_, target_;
    double pace_;
    SmoothNoise x_, y_, z_, look_x_, look_z_, roll_;
    Hand hand_;
};

}  // namespace posefusion::synth
