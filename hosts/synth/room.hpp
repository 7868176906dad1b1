#pragma once
#include <cstdint>
#include <vector>

#include "hosts/synth/mesh.hpp"

/// The furnished room: geometry, what blocks the way, where one can sit and stand.
namespace posefusion::synth {

struct Seat {
    Vector2f center;
    float yaw = 0;  ///< direction that the sitter faces, rad
};

/// A panel in the ceiling that shines down.
struct Lamp {
    Vector3f center;
    Vector2f half;    ///< metres along x and y
    float power = 0;  ///< irradiance at 1 m below, before exposure
};

struct Room {
    explicit Room(std::uint64_t seed);

    Vector3f size;  ///< metres; the room is [0, size]
    RoomMesh mesh;
    std::vector<Obstacle> obstacles;
    std::vector<Lamp> lamps;
    std::vector<Seat> seats;
    std::vector<Vector2f> spots;  ///< places in view to walk to
    std::vector<Vector2f> exits;  ///< places out of the camera's view
    Vector3f camera_home;         ///< middle of the space kept free for the camera
    Vector3f camera_target;       ///< what the camera looks at, on average

    /// Distance to the nearest furniture or wall, metres, 0 inside.
    [[nodiscard]] float clearance(const Vector3f& point) const;
};

/// Half sizes of the space that belongs to the camera: nothing stands there and nobody walks there.
inline const Vector3f kCameraSpace{0.75f, 0.30f, 0.25f};

}  // namespace posefusion::synth
