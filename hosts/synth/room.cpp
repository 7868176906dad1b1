#include "hosts/synth/room.hpp"

#include <algorithm>

#include "hosts/synth/furnisher.hpp"
#include "hosts/synth/furniture.hpp"
#include "hosts/synth/large_room.hpp"

namespace posefusion::synth {
namespace {

void build_shell(Furnisher& f) {
    const Vector3f s = f.room.size;
    const MeshBuilder at(f.room.mesh, Eigen::Isometry3f::Identity());
    const Material far = f.rng.chance(0.5f) ? Wallpaper : Plaster;
    at.quad({0, s.y(), 0}, {s.x(), 0, 0}, {0, -s.y(), 0}, FloorBoards, Vector3f::Ones(), {f.rng.uniform(0, 2), 0});
    at.quad({0, 0, s.z()}, {s.x(), 0, 0}, {0, s.y(), 0}, Ceiling);
    at.quad({0, s.y(), s.z()}, {s.x(), 0, 0}, {0, 0, -s.z()}, far);
    at.quad({s.x(), 0, s.z()}, {-s.x(), 0, 0}, {0, 0, -s.z()}, Plaster);
    at.quad({0, 0, s.z()}, {0, s.y(), 0}, {0, 0, -s.z()}, Plaster, Vector3f::Ones(), {0.7f, 0});
    at.quad({s.x(), s.y(), s.z()}, {0, -s.y(), 0}, {0, 0, -s.z()}, far == Wallpaper ? Plaster : Wallpaper);
    // Skirting boards.
    const float t = 0.015f, h = 0.09f;
    at.box({0, s.y() - t, 0}, {s.x(), s.y(), h}, Plain, Vector3f::Constant(0.85f));
    at.box({0, 0, 0}, {t, s.y(), h}, Plain, Vector3f::Constant(0.85f));
    at.box({s.x() - t, 0, 0}, {s.x(), s.y(), h}, Plain, Vector3f::Constant(0.85f));
}

void light_room(Room& room) {
    for (const float y : {0.30f, 0.72f})
        add_lamp(room, {0.5f * room.size.x(), y * room.size.y()}, {0.75f, 0.30f}, 2.2f);
}

/// A shelf of books whose door swings towards the camera. Its mesh is part of what moves.
void add_wardrobe(Furnisher& f, float x) {
    const float y = f.room.size.y(), width = f.rng.uniform(0.75f, 0.9f), height = f.rng.uniform(1.8f, 2.05f);
    const float depth = 0.42f, half = 0.5f * width, gap = 0.012f;
    add_bookshelf(f.at(x, y, 0), f.rng, width, height, depth);
    f.block(x, y, 0, {-half, -depth}, {half, 0}, 0, height);
    f.block(x, y - depth, 0, {-half - 0.05f, -width - 0.05f}, {half + 0.05f, 0}, 0, height);
    const bool left = f.rng.chance(0.5f);
    const Vector2f axis = f.place(x, y - depth - gap) + Vector2f(left ? -half : half, 0);
    f.room.wardrobe = Hinge{{axis.x(), axis.y(), 0.02f}, left ? 0 : kPi, left ? -1.0f : 1.0f, width, height - 0.04f};
}

void add_screen(Furnisher& f, float x, float z) {
    const Vector2f size(f.rng.uniform(0.95f, 1.25f), f.rng.uniform(0.55f, 0.7f)), half = 0.5f * size;
    constexpr float kThick = 0.05f, kFrame = 0.02f;
    const float y = f.room.size.y();
    const MeshBuilder at = f.at(x, y, 0, z);
    const Vector3f black = Vector3f::Constant(0.06f);
    at.box({-half.x(), -kThick + 0.005f, -half.y()}, {half.x(), 0, half.y()}, Plain, black);
    for (const float side : {-half.x() - kFrame, half.x()})
        at.box({side, -kThick, -half.y() - kFrame}, {side + kFrame, 0, half.y() + kFrame}, Plain, black);
    for (const float side : {-half.y() - kFrame, half.y()})
        at.box({-half.x(), -kThick, side}, {half.x(), 0, side + kFrame}, Plain, black);
    const Vector2f middle = f.place(x, y - kThick);
    f.room.screen = ScreenPlace{{middle.x(), middle.y(), z}, 0, size};
}

void furnish_far_wall(Furnisher& f, bool for_movers) {
    const float y = f.room.size.y();
    const float shelf = 0.78f + f.jitter(0.08f), tall = f.rng.uniform(1.75f, 2.05f);
    add_bookshelf(f.at(shelf, y, 0), f.rng, 1.0f, tall, 0.30f);
    f.block(shelf, y, 0, {-0.5f, -0.30f}, {0.5f, 0}, 0, tall);
    if (for_movers) {
        add_wardrobe(f, 2.30f + f.jitter(0.25f));
    } else {
        add_window(f.at(2.30f, y, 0), f.rng, 1.2f, 0.98f, 2.10f);
        f.block(2.30f, y, 0, {-1.0f, -0.20f}, {1.0f, 0}, 0, 2.2f);
    }
    const float board = 4.02f + f.jitter(0.08f);
    add_sideboard(f.at(board, y, 0), f.rng, 1.30f, 0.78f, 0.42f);
    f.block(board, y, 0, {-0.65f, -0.46f}, {0.65f, 0}, 0, 1.1f);
    if (for_movers && f.rng.chance(0.7f)) {
        add_screen(f, 4.02f + f.jitter(0.1f), 1.45f + f.jitter(0.1f));
    } else {
        const int first = f.rng.index(kPosterCount);
        add_poster(f.at(3.66f + f.jitter(0.03f), y, 0, 1.60f + f.jitter(0.06f)), first);
        add_poster(f.at(4.42f + f.jitter(0.03f), y, 0, 1.60f + f.jitter(0.06f)), (first + 1) % kPosterCount);
    }
    add_plant(f.at(5.02f, y - 0.36f, 0), f.rng, f.rng.uniform(1.1f, 1.5f));
    f.block(5.02f, y - 0.36f, 0, {-0.3f, -0.3f}, {0.3f, 0.3f}, 0, 1.5f);
}

void furnish_side_walls(Furnisher& f) {
    const float w = f.room.size.x();
    const float sofa = 2.80f + f.jitter(0.12f);
    add_sofa(f.at(0.02f, sofa, kEast), f.rng, 1.75f, 0.86f);
    f.block(0.02f, sofa, kEast, {-0.875f, -0.87f}, {0.875f, 0}, 0, 0.85f);
    const int first = f.rng.index(kPosterCount);
    add_poster(f.at(0.0f, sofa - 0.45f, kEast, 1.50f), (first + 2) % kPosterCount);
    add_poster(f.at(0.0f, sofa + 0.45f, kEast, 1.50f), (first + 3) % kPosterCount);
    add_floor_lamp(f.at(0.30f, 1.62f, 0));
    f.block(0.30f, 1.62f, 0, {-0.2f, -0.2f}, {0.2f, 0.2f}, 0, 1.7f);
    const float desk = 2.60f + f.jitter(0.15f);
    add_desk(f.at(w, desk, -kEast), f.rng, 1.35f, 0.64f);
    f.block(w, desk, -kEast, {-0.675f, -0.66f}, {0.675f, 0}, 0, 1.3f);
    add_poster(f.at(w, desk + 0.15f, -kEast, 1.68f), first);
    add_cartons(f.at(w - 0.32f, 1.50f, 0), f.rng, 3);
    f.block(w - 0.32f, 1.50f, 0, {-0.28f, -0.26f}, {0.28f, 0.26f}, 0, 1.1f);
    f.at(w - 0.01f, 0.75f, -kEast).quad({-0.45f, -0.01f, 2.0f}, {0.9f, 0, 0}, {0, 0, -2.0f}, Door);
}

/// A chair; true if somebody can get onto it.
void add_seat(Furnisher& f, float x, float y, float yaw) {
    add_chair(f.at(x, y, yaw), f.rng);
    f.block(x, y, yaw, {-0.215f, -0.22f}, {0.215f, 0.216f}, 0, 0.9f);
    f.room.seats.push_back({f.place(x, y), f.turn(yaw) - 0.5f * kPi});
}

void furnish_middle(Furnisher& f) {
    const float x = 0.5f * f.room.size.x() + f.jitter(0.08f), y = 2.60f + f.jitter(0.08f);
    f.at(x, y, 0).quad({-1.2f, 0.9f, 0.006f}, {2.4f, 0, 0}, {0, -1.8f, 0}, Carpet);
    add_table(f.at(x, y, 0), f.rng, 1.20f, 0.75f);
    f.block(x, y, 0, {-0.6f, -0.375f}, {0.6f, 0.375f}, 0, 1.0f);
    // One chair tucked under the far side, two beside the table that people use.
    add_chair(f.at(x + f.jitter(0.2f), y + 0.46f, 0.0f), f.rng);
    f.block(x, y + 0.46f, 0, {-0.42f, -0.22f}, {0.42f, 0.22f}, 0, 0.9f);
    const auto angle = [&] { return f.rng.chance(0.6f) ? f.jitter(0.6f) : f.jitter(0.3f) + kPi; };
    add_seat(f, x - 0.98f, y - 0.10f + f.jitter(0.1f), angle());
    add_seat(f, x + 0.98f, y + f.jitter(0.15f), angle());
}

/// Space for things that move.
void clear_middle(Furnisher& f) {
    const float x = 0.5f * f.room.size.x() + f.jitter(0.3f), y = 2.40f + f.jitter(0.2f);
    f.at(x, y, 0).quad({-1.2f, 0.9f, 0.006f}, {2.4f, 0, 0}, {0, -1.8f, 0}, Carpet);
    if (f.rng.chance(0.5f)) return;
    // One piece that things move behind.
    const float aside = f.rng.uniform(0.6f, 1.1f) * (f.rng.chance(0.5f) ? 1.0f : -1.0f), ahead = f.jitter(0.25f);
    add_cartons(f.at(x + aside, y + ahead, 0), f.rng, 2);
    f.block(x + aside, y + ahead, 0, {-0.28f, -0.26f}, {0.28f, 0.26f}, 0, 1.1f);
}

/// A living room that a camera at its south wall overlooks.
void furnish_living_room(Furnisher& f, bool for_movers) {
    Room& room = f.room;
    room.size = {5.4f, 4.4f, 2.5f};
    room.camera_home = {2.7f, 0.46f, 1.42f};
    room.camera_target = {2.7f, 3.0f, 0.98f};
    room.camera_space.push_back(
        {room.camera_home.head<2>(), Vector2f(kCameraSpace.x(), kCameraSpace.y() + 0.30f), 0, 0, room.size.z()});
    room.air.emplace_back(0.5f * room.size);
    build_shell(f);
    light_room(room);
    furnish_far_wall(f, for_movers);
    furnish_side_walls(f);
    if (for_movers)
        clear_middle(f);
    else
        furnish_middle(f);
    for (const auto& [x, y] : {std::pair{2.00f, 1.86f},
                               {2.7f, 1.84f},
                               {3.40f, 1.86f},
                               {1.45f, 3.50f},
                               {2.30f, 3.60f},
                               {3.15f, 3.55f},
                               {4.0f, 3.40f}})
        room.spots.push_back(f.place(x, y));
    room.exits = {f.place(0.45f, 1.05f), f.place(4.95f, 0.95f)};
}

}  // namespace

void add_lamp(Room& room, const Vector2f& at, const Vector2f& half, float power) {
    const float top = room.size.z();
    MeshBuilder(room.mesh, Eigen::Isometry3f::Identity())
        .box({at.x() - half.x(), at.y() - half.y(), top - 0.025f}, {at.x() + half.x(), at.y() + half.y(), top},
             LampGlow);
    room.lamps.push_back({{at.x(), at.y(), top - 0.03f}, half, power});
}

Room::Room(std::uint64_t seed, RoomKind kind, bool fresh_paint) : size(Vector3f::Zero()) {
    Rng rng(seed);
    mirrored = rng.chance(0.5f);
    Furnisher f{*this, rng, mirrored};
    if (kind == RoomKind::Large)
        furnish_large_room(f, fresh_paint ? FreshPaint : Plaster);
    else
        furnish_living_room(f, kind == RoomKind::Cleared);
}

float Room::clearance(const Vector3f& point) const {
    const Vector3f wall = point.cwiseMin(size - point);
    float nearest = std::max(wall.minCoeff(), 0.0f);
    for (const Obstacle& obstacle : obstacles) nearest = std::min(nearest, obstacle.distance(point));
    return nearest;
}

}  // namespace posefusion::synth
