#pragma once
#include <Eigen/Geometry>

#include "hosts/synth/hand.hpp"
#include "hosts/synth/room.hpp"
#include "hosts/synth/scenario.hpp"

namespace posefusion::synth {

/// A camera carried along the lane of a large room: it bobs with every step, looks ahead and to the outer side, varying
/// with time, and along the bare wall straight at it. On a second pass with a sidestep, the camera is 0.1-0.2 m beside
/// the first path and rotated by 4-9 degrees.
class LanePath {
public:
    /// @param pace  how fast it looks around, 1 = calm
    LanePath(const Room& room, Itinerary itinerary, std::uint64_t seed, double pace);
    /// T_world_camera: camera x right, y down, z forward. Smooth in t (seconds).
    [[nodiscard]] Eigen::Isometry3d at(double t) const;

private:
    struct Progress {
        double turns = 0, sidestep = 0;
    };
    [[nodiscard]] Progress progress(double t) const;

    Lane lane_;
    bool mirrored_;
    double width_, eye_height_, pace_;
    Itinerary itinerary_;
    SmoothNoise outward_, glance_, nod_, across_, height_, roll_;
    Hand hand_;
    Eigen::Vector3d sidestep_;  ///< metres: along, across the lane, up
    double sidestep_turn_;      ///< rad
};

}  // namespace posefusion::synth
