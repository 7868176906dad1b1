#pragma once
#include <cmath>

#include "hosts/synth/mesh_builder.hpp"
#include "hosts/synth/random.hpp"
#include "hosts/synth/room.hpp"

namespace posefusion::synth {

inline constexpr float kEast = 0.5f * kPi;  ///< yaw of pieces whose back is at the wall x = 0: they face +x

/// Places pieces on the floor plan; a mirrored room has left and right exchanged.
struct Furnisher {
    Room& room;
    Rng rng;
    bool mirrored;

    [[nodiscard]] Vector2f place(float x, float y) const { return {mirrored ? room.size.x() - x : x, y}; }
    [[nodiscard]] float turn(float yaw) const { return mirrored ? -yaw : yaw; }
    [[nodiscard]] MeshBuilder at(float x, float y, float yaw, float z = 0) const {
        const Vector2f p = place(x, y);
        return MeshBuilder(room.mesh, Eigen::Isometry3f::Identity()).at({p.x(), p.y(), z}, turn(yaw));
    }
    /// @param x,y,yaw  frame of the piece  @param low,high  its extent in that frame
    void block(float x, float y, float yaw, const Vector2f& low, const Vector2f& high, float bottom, float top) {
        const float angle = turn(yaw), c = std::cos(angle), s = std::sin(angle);
        Vector2f middle = 0.5f * (low + high);
        if (mirrored) middle.x() = -middle.x();
        const Vector2f center =
            place(x, y) + Vector2f(c * middle.x() - s * middle.y(), s * middle.x() + c * middle.y());
        room.obstacles.push_back({center, 0.5f * (high - low), angle, bottom, top});
    }
    float jitter(float amount) { return rng.uniform(-amount, amount); }
};

/// A panel in the ceiling and its light.
void add_lamp(Room& room, const Vector2f& at, const Vector2f& half, float power);

}  // namespace posefusion::synth
