#pragma once
#include "hosts/synth/mesh.hpp"
#include "hosts/synth/random.hpp"

/// What movers look like. Sizes in metres; z up.
namespace posefusion::synth {

/// Stands on z = 0 and is pushed along x. @param size  length, width, height
[[nodiscard]] RoomMesh cart_mesh(Rng& rng, const Vector3f& size);
/// The origin is its middle.
[[nodiscard]] RoomMesh carton_mesh(Rng& rng, const Vector3f& size);
/// The leaf of a door: the hinge is the z axis, the leaf extends along x; closed, its back is in the plane y = 0.
/// @param front  -1: it faces -y, 1: y
[[nodiscard]] RoomMesh leaf_mesh(Rng& rng, float width, float height, float front);
/// The origin is its middle.
[[nodiscard]] RoomMesh ball_mesh(Rng& rng, float radius);
/// Stands on z = 0, the backrest at +y.
[[nodiscard]] RoomMesh chair_mesh(Rng& rng);
/// The panel that shows the picture: the origin is its middle, it faces -y.
[[nodiscard]] RoomMesh screen_mesh(const Vector2f& size);

}  // namespace posefusion::synth
