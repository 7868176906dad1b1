#pragma once
#include <cstdint>
#include <optional>
#include <vector>

#include "hosts/synth/lane.hpp"
#include "hosts/synth/mesh.hpp"

/// The furnished room: geometry, obstacles, and places to sit and stand.
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

enum class RoomKind : std::uint8_t {
    Living,   ///< 5.4 x 4.4 m, seen by a camera that stays in place
    Cleared,  ///< the same with its middle cleared, a wardrobe with a door, and often a screen on the wall
    Large,    ///< 9 x 7 m around a block of walls: no point sees more than a part of it
};

/// Of the door of a wardrobe.
struct Hinge {
    Vector3f foot;  ///< lower end of its axis
    float yaw_closed = 0,
          sense = 1;  ///< direction of the closed leaf from the hinge, and which way it opens; the leaf faces y * sense
    float width = 0, height = 0;  ///< of the leaf
};

struct ScreenPlace {
    Vector3f middle;
    float yaw = 0;  ///< it faces -y of a frame turned by this, rad
    Vector2f size;  ///< metres
};

struct Room {
    /// @param fresh_paint  Large only: the walls have hardly any texture
    explicit Room(std::uint64_t seed, RoomKind kind = RoomKind::Living, bool fresh_paint = true);

    Vector3f size;          ///< metres; the room is [0, size]
    bool mirrored = false;  ///< left and right (x) are swapped
    RoomMesh mesh;
    std::vector<Obstacle> obstacles;
    std::vector<Lamp> lamps;
    std::vector<Seat> seats;
    std::vector<Vector2f> spots;  ///< visible places to walk to
    std::vector<Vector2f> exits;  ///< places out of the camera's view
    Vector3f camera_home;         ///< middle of the space kept free for the camera; Large: where its walk begins
    Vector3f camera_target;       ///< what the camera looks at, on average; Living only

    std::vector<Obstacle> camera_space;  ///< kept free for the camera: people walk around it
    std::vector<Vector3f> air;           ///< points in free space, of which one is near every lit surface

    std::optional<Hinge> wardrobe;      ///< Cleared: before it the door has room to swing
    std::optional<ScreenPlace> screen;  ///< Cleared: the panel, of which the mesh has only the case

    std::optional<Lane> lane;                ///< Large: the camera's way, before mirroring
    std::vector<Vector2f> beside_loop;       ///< Large: places near the loop's, but not in view from it
    std::vector<Vector2f> in_front_of_loop;  ///< Large: places between the camera and what it sees at the loop's place

    /// Distance to the nearest furniture or wall, metres, 0 inside.
    [[nodiscard]] float clearance(const Vector3f& point) const;
};

/// Half sizes of the space that belongs to the camera of the living room: nothing stands there and nobody walks there.
inline const Vector3f kCameraSpace{0.75f, 0.30f, 0.25f};

}  // namespace posefusion::synth
