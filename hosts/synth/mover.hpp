#pragma once
#include <Eigen/Geometry>
#include <functional>
#include <vector>

#include "hosts/synth/mesh.hpp"
#include "hosts/synth/synth.hpp"

/// Rigid things that move about the room.
namespace posefusion::synth {

using Eigen::Isometry3f;

/// The label of the first mover in the masks; people are below.
inline constexpr int kFirstMoverLabel = 101;

/// Where a mover is, and what it shows.
struct MoverPose {
    Isometry3f T_world_object = Isometry3f::Identity();
    Vector2f picture = Vector2f::Zero();  ///< shift of the texture, metres along u and v: a film on a screen
};

/// A sphere that approximates a part of something that moves, for the ambient shadow that it casts.
struct Shade {
    Vector3f center;
    float radius;
};

struct Mover {
    SynthObjectKind kind = SynthObjectKind::Cart;
    int label = 0;                          ///< in the masks; 0: it stands still, only its picture changes
    RoomMesh mesh;                          ///< in its own frame
    std::vector<Shade> shades;              ///< in its own frame
    std::function<MoverPose(double t)> at;  ///< t in seconds
};

}  // namespace posefusion::synth
