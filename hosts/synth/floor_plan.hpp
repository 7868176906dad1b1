#pragma once
#include <vector>

#include "hosts/synth/room.hpp"

/// Where people can walk, and how they get from one place to another.
namespace posefusion::synth {

inline constexpr float kRouteSpacing = 0.02f;  ///< metres

class FloorPlan {
public:
    explicit FloorPlan(const Room& room);

    /// A smooth route that keeps its distance from obstacles, a point every kRouteSpacing; empty if there is none.
    [[nodiscard]] std::vector<Vector2f> route(const Vector2f& from, const Vector2f& to) const;
    /// Clearance at a point: distance to the nearest obstacle, wall or the camera's space, metres.
    [[nodiscard]] float clearance(const Vector2f& p) const;

private:
    [[nodiscard]] int cell(const Vector2f& p) const;
    [[nodiscard]] Vector2f middle(int cell) const;
    [[nodiscard]] std::vector<Vector2f> shortest(int from, int to) const;
    const Room& room_;
    int columns_, rows_;
    std::vector<float> clearance_;  ///< per cell
};

/// Half a person's width, with the arms close to the body: what a route keeps free, metres.
inline constexpr float kWalkerRadius = 0.26f;

}  // namespace posefusion::synth
