#pragma once
#include "hosts/synth/mesh_builder.hpp"
#include "hosts/synth/random.hpp"

/// Pieces of furniture. Every piece stands on z = 0 of its frame and faces its -y; pieces for walls have their back at
/// y = 0. Sizes in metres.
namespace posefusion::synth {

inline constexpr float kSeatHeight = 0.46f;
inline constexpr float kTableHeight = 0.74f;

void add_bookshelf(const MeshBuilder& at, Rng& rng, float width, float height, float depth);
void add_table(const MeshBuilder& at, Rng& rng, float width, float depth);
void add_chair(const MeshBuilder& at, Rng& rng);
void add_sofa(const MeshBuilder& at, Rng& rng, float width, float depth);
void add_desk(const MeshBuilder& at, Rng& rng, float width, float depth);
void add_sideboard(const MeshBuilder& at, Rng& rng, float width, float height, float depth);
void add_plant(const MeshBuilder& at, Rng& rng, float height);
void add_cartons(const MeshBuilder& at, Rng& rng, int count);
void add_floor_lamp(const MeshBuilder& at);
void add_window(const MeshBuilder& at, Rng& rng, float width, float sill, float top);
/// 0.6 x 0.8 m, hangs on a wall; the origin is the middle of the picture.
void add_poster(const MeshBuilder& at, int kind);

}  // namespace posefusion::synth
