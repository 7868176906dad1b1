#include "hosts/synth/large_room.hpp"

#include "hosts/synth/furniture.hpp"

namespace posefusion::synth {
namespace {

// The plan, in metres.
constexpr float kWidth = 9.0f, kDepth = 7.0f, kHeight = 2.6f;
const Vector2f kBlockHalf(1.6f, 0.8f);
constexpr float kLaneFromBlock = 0.55f;  ///< middle of the camera's way
constexpr float kLaneHalfWidth = 0.35f;
constexpr float kLaneCorner = 0.9f;  ///< radius
constexpr float kLaneStart = 5.75f;  ///< x on the south side
constexpr float kEyeHeight = 1.42f;  ///< of the camera
constexpr int kAirPoints = 32;       ///< along the lane
constexpr float kNorth = kPi;        ///< yaw of pieces whose back is at the wall y = 0: they face +y
const Vector3f kLinoleum(0.55f, 0.57f, 0.58f);

Vector2f middle() { return 0.5f * Vector2f(kWidth, kDepth); }

void build_shell(Furnisher& f, Material walls) {
    const MeshBuilder at(f.room.mesh, Eigen::Isometry3f::Identity());
    const Vector3f shade = Vector3f::Constant(f.rng.uniform(0.92f, 1.0f));
    at.quad({0, kDepth, 0}, {kWidth, 0, 0}, {0, -kDepth, 0}, FloorBoards, Vector3f::Ones(), {f.rng.uniform(0, 2), 0});
    at.quad({0, 0, kHeight}, {kWidth, 0, 0}, {0, kDepth, 0}, Ceiling);
    at.quad({0, kDepth, kHeight}, {kWidth, 0, 0}, {0, 0, -kHeight}, walls, shade, {f.rng.uniform(0, 2), 0});
    at.quad({kWidth, 0, kHeight}, {-kWidth, 0, 0}, {0, 0, -kHeight}, walls, shade, {f.rng.uniform(0, 2), 0});
    at.quad({0, 0, kHeight}, {0, kDepth, 0}, {0, 0, -kHeight}, walls, shade, {0.7f, 0});
    at.quad({kWidth, kDepth, kHeight}, {0, -kDepth, 0}, {0, 0, -kHeight}, walls, shade, {1.3f, 0});
    // The block.
    const Vector2f low = middle() - kBlockHalf, high = middle() + kBlockHalf, size = high - low;
    at.quad({low.x(), low.y(), kHeight}, {size.x(), 0, 0}, {0, 0, -kHeight}, walls, shade);
    at.quad({high.x(), high.y(), kHeight}, {-size.x(), 0, 0}, {0, 0, -kHeight}, walls, shade, {0.4f, 0});
    at.quad({low.x(), high.y(), kHeight}, {0, -size.y(), 0}, {0, 0, -kHeight}, Wallpaper);
    at.quad({high.x(), low.y(), kHeight}, {0, size.y(), 0}, {0, 0, -kHeight}, Wallpaper);
    f.room.obstacles.push_back({middle(), kBlockHalf, 0, 0, kHeight});
    // The north side's floor has no boards to hold on to.
    const float y = high.y() - 0.2f;
    at.quad({1.8f, kDepth, 0.004f}, {5.4f, 0, 0}, {0, y - kDepth, 0}, Plain, kLinoleum);
}

void light_large_room(Room& room) {
    for (const float y : {1.35f, kDepth - 1.35f}) add_lamp(room, {middle().x(), y}, {1.1f, 0.30f}, 3.0f);
    for (const float x : {1.45f, kWidth - 1.45f}) add_lamp(room, {x, middle().y()}, {0.30f, 1.1f}, 3.0f);
}

/// What the camera sees at the start and when it comes back.
void furnish_south_side(Furnisher& f) {
    const float shelf = 4.55f + f.jitter(0.1f), tall = f.rng.uniform(1.75f, 2.05f);
    add_bookshelf(f.at(shelf, 0, kNorth), f.rng, 1.0f, tall, 0.30f);
    f.block(shelf, 0, kNorth, {-0.5f, -0.30f}, {0.5f, 0}, 0, tall);
    const int first = f.rng.index(kPosterCount);
    add_poster(f.at(3.55f + f.jitter(0.05f), 0, kNorth, 1.60f + f.jitter(0.06f)), first);
    const float board = 2.85f + f.jitter(0.1f);
    add_sideboard(f.at(board, 0, kNorth), f.rng, 1.30f, 0.78f, 0.42f);
    f.block(board, 0, kNorth, {-0.65f, -0.46f}, {0.65f, 0}, 0, 1.1f);
    add_poster(f.at(2.65f + f.jitter(0.05f), 0, kNorth, 1.60f + f.jitter(0.06f)), (first + 1) % kPosterCount);
    add_plant(f.at(1.70f, 0.36f, 0), f.rng, f.rng.uniform(1.1f, 1.5f));
    f.block(1.70f, 0.36f, 0, {-0.3f, -0.3f}, {0.3f, 0.3f}, 0, 1.5f);
    add_floor_lamp(f.at(5.55f, 0.30f, 0));
    f.block(5.55f, 0.30f, 0, {-0.2f, -0.2f}, {0.2f, 0.2f}, 0, 1.7f);
    f.at(7.2f, 0.01f, kNorth).quad({-0.45f, -0.01f, 2.0f}, {0.9f, 0, 0}, {0, 0, -2.0f}, Door);
}

void furnish_west_side(Furnisher& f) {
    const float sofa = 2.75f + f.jitter(0.15f);
    add_sofa(f.at(0.02f, sofa, kEast), f.rng, 1.75f, 0.86f);
    f.block(0.02f, sofa, kEast, {-0.875f, -0.87f}, {0.875f, 0}, 0, 0.85f);
    const int first = f.rng.index(kPosterCount);
    add_poster(f.at(0, sofa - 0.45f, kEast, 1.50f), first);
    add_poster(f.at(0, sofa + 0.45f, kEast, 1.50f), (first + 2) % kPosterCount);
    add_window(f.at(0, 5.0f + f.jitter(0.1f), kEast), f.rng, 1.2f, 0.98f, 2.10f);
    f.block(0, 5.0f, kEast, {-1.1f, -0.20f}, {1.1f, 0}, 0, 2.2f);
    add_plant(f.at(0.40f, 6.5f, 0), f.rng, f.rng.uniform(1.0f, 1.4f));
    f.block(0.40f, 6.5f, 0, {-0.3f, -0.3f}, {0.3f, 0.3f}, 0, 1.4f);
}

/// Almost nothing: this is where a tracker slides along the wall.
void furnish_north_side(Furnisher& f) {
    const float x = 6.95f + f.jitter(0.15f);
    add_cartons(f.at(x, kDepth - 0.35f, 0), f.rng, 2);
    f.block(x, kDepth - 0.35f, 0, {-0.28f, -0.26f}, {0.28f, 0.26f}, 0, 0.9f);
}

void furnish_east_side(Furnisher& f) {
    const float desk = 4.3f + f.jitter(0.2f);
    add_desk(f.at(kWidth, desk, -kEast), f.rng, 1.35f, 0.64f);
    f.block(kWidth, desk, -kEast, {-0.675f, -0.66f}, {0.675f, 0}, 0, 1.3f);
    const int first = f.rng.index(kPosterCount);
    add_poster(f.at(kWidth, desk + 0.15f, -kEast, 1.68f), first);
    add_poster(f.at(kWidth, 2.6f + f.jitter(0.1f), -kEast, 1.60f), (first + 1) % kPosterCount);
    add_chair(f.at(kWidth - 0.35f, 2.6f, -kEast), f.rng);
    f.block(kWidth - 0.35f, 2.6f, -kEast, {-0.22f, -0.22f}, {0.22f, 0.22f}, 0, 0.9f);
    add_bookshelf(f.at(kWidth, 6.0f, -kEast), f.rng, 0.9f, 1.9f, 0.30f);
    f.block(kWidth, 6.0f, -kEast, {-0.45f, -0.30f}, {0.45f, 0}, 0, 1.9f);
}

void mark_places(Furnisher& f) {
    Room& room = f.room;
    const Vector2f half = kBlockHalf + Vector2f::Constant(kLaneFromBlock);
    room.lane.emplace(middle(), half, kLaneCorner, kLaneStart);
    const auto strip = [&](const Vector2f& at, const Vector2f& size) {
        room.camera_space.push_back({at, size, 0, 0, kHeight});
    };
    for (const float side : {-1.0f, 1.0f}) {
        strip(middle() + Vector2f(0, side * half.y()), {half.x() + kLaneHalfWidth, kLaneHalfWidth});
        strip(middle() + Vector2f(side * half.x(), 0), {kLaneHalfWidth, half.y() + kLaneHalfWidth});
    }
    for (int i = 0; i < kAirPoints; ++i) {
        const Vector2f p = room.lane->at(static_cast<double>(i) / kAirPoints);
        const Vector2f q = f.place(p.x(), p.y());
        room.air.emplace_back(q.x(), q.y(), 0.5f * kHeight);
    }
    const Vector2f home = room.lane->at(0), placed = f.place(home.x(), home.y());
    room.camera_home = {placed.x(), placed.y(), kEyeHeight};
    const auto places = [&](std::initializer_list<Vector2f> list) {
        std::vector<Vector2f> out;
        for (const Vector2f& p : list) out.push_back(f.place(p.x(), p.y()));
        return out;
    };
    room.spots = places({{1.45f, 1.25f},
                         {3.2f, 1.15f},
                         {4.6f, 1.10f},
                         {7.6f, 1.2f},
                         {7.7f, 3.4f},
                         {7.6f, 5.6f},
                         {4.9f, 5.9f},
                         {3.0f, 5.8f},
                         {1.4f, 5.7f},
                         {1.45f, 3.9f}});
    room.exits = places({{6.8f, 1.0f}, {1.4f, 6.2f}});
    room.beside_loop = places({{7.0f, 1.15f}, {7.9f, 1.3f}, {7.5f, 0.8f}, {6.7f, 0.8f}, {8.3f, 1.0f}});
    room.in_front_of_loop = places({{4.9f, 1.20f}, {4.1f, 1.05f}, {3.4f, 1.25f}, {2.6f, 1.1f}});
}

}  // namespace

void furnish_large_room(Furnisher& f, Material walls) {
    f.room.size = {kWidth, kDepth, kHeight};
    build_shell(f, walls);
    light_large_room(f.room);
    furnish_south_side(f);
    furnish_west_side(f);
    furnish_north_side(f);
    furnish_east_side(f);
    mark_places(f);
}

}  // namespace posefusion::synth
