#include "hosts/synth/mover_shapes.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "hosts/synth/furniture.hpp"
#include "hosts/synth/mesh_builder.hpp"

namespace posefusion::synth {
namespace {

constexpr int kBallBands = 14;  ///< from pole to pole

MeshBuilder builder(RoomMesh& mesh) { return {mesh, Eigen::Isometry3f::Identity()}; }
Vector3f pastel(Rng& rng) { return {rng.uniform(0.45f, 1), rng.uniform(0.45f, 1), rng.uniform(0.45f, 1)}; }
Vector2f somewhere(Rng& rng) { return {rng.uniform(0, 0.6f), rng.uniform(0, 0.8f)}; }
/// What large faces show.
Material decor(Rng& rng) {
    constexpr std::array kDecor{Cardboard, Motley, Poster1, Poster2, Fabric, BookSpine};
    return kDecor[static_cast<std::size_t>(rng.index(static_cast<int>(kDecor.size())))];
}

}  // namespace

RoomMesh cart_mesh(Rng& rng, const Vector3f& size) {
    RoomMesh mesh;
    const MeshBuilder at = builder(mesh);
    const float x = 0.5f * size.x(), y = 0.5f * size.y(), floor = 0.16f, board = 0.03f, post = 0.02f;
    for (const float wheel : {-x + 0.07f, x - 0.07f})
        for (const float side : {-y + 0.05f, y - 0.05f})
            at.box({wheel - 0.05f, side - 0.02f, 0}, {wheel + 0.05f, side + 0.02f, 0.10f}, Plain,
                   Vector3f::Constant(0.15f));
    at.box({-x, -y, floor - board}, {x, y, floor}, Metal, Vector3f::Constant(1.5f));
    // A load that fills most of it: crates side by side, each with its own look.
    const int crates = 1 + rng.index(3);
    for (int i = 0; i < crates; ++i) {
        const float from = -x + 0.05f + (size.x() - 0.10f) * static_cast<float>(i) / static_cast<float>(crates);
        const float to = from + (size.x() - 0.10f) / static_cast<float>(crates) - 0.012f;
        const float inset = rng.uniform(0.01f, 0.06f);
        at.box({from, -y + inset, floor}, {to, y - inset, size.z() * rng.uniform(0.65f, 0.95f)}, decor(rng),
               pastel(rng), somewhere(rng));
    }
    // The handle at the end that is pushed.
    for (const float side : {-y + post, y - post})
        at.box({-x, side - post, floor}, {-x + 2 * post, side + post, size.z()}, Metal, Vector3f::Constant(1.3f));
    at.box({-x, -y, size.z() - 2 * post}, {-x + 2 * post, y, size.z()}, Plain, {0.75f, 0.12f, 0.10f});
    return mesh;
}

RoomMesh carton_mesh(Rng& rng, const Vector3f& size) {
    RoomMesh mesh;
    const Vector3f half = 0.5f * size;
    builder(mesh).box(-half, half, decor(rng), pastel(rng), somewhere(rng));
    return mesh;
}

RoomMesh leaf_mesh(Rng& rng, float width, float height, float front) {
    constexpr float kThick = 0.035f, kHandle = 0.05f;
    RoomMesh mesh;
    const MeshBuilder at = builder(mesh);
    // A solid from y = near to y = far before the back of the leaf.
    const auto solid = [&](float x0, float x1, float near, float far, float z0, float z1, Material material,
                           const Vector3f& tint, const Vector2f& uv) {
        at.box({x0, std::min(front * near, front * far), z0}, {x1, std::max(front * near, front * far), z1}, material,
               tint, uv);
    };
    const Material face = rng.chance(0.6f) ? Door : decor(rng);
    solid(0, width, 0, kThick, 0, height, face, pastel(rng), somewhere(rng));
    solid(width - 0.09f, width - 0.05f, kThick, kThick + kHandle, 0.52f * height, 0.52f * height + 0.12f, Metal,
          Vector3f::Constant(1.6f), Vector2f::Zero());
    return mesh;
}

RoomMesh ball_mesh(Rng& rng, float radius) {
    RoomMesh mesh;
    std::vector<Vector2f> profile;
    for (int i = 0; i <= kBallBands; ++i) {
        const float angle = kPi * (static_cast<float>(i) / kBallBands - 0.5f);
        profile.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
    }
    builder(mesh).lathe(profile, Motley, pastel(rng), 2 * kBallBands);
    for (RoomVertex& vertex : mesh.vertices) vertex.normal = vertex.position.normalized();
    return mesh;
}

RoomMesh chair_mesh(Rng& rng) {
    RoomMesh mesh;
    add_chair(builder(mesh), rng);
    return mesh;
}

RoomMesh screen_mesh(const Vector2f& size) {
    RoomMesh mesh;
    builder(mesh).quad({-0.5f * size.x(), 0, 0.5f * size.y()}, {size.x(), 0, 0}, {0, 0, -size.y()}, Film);
    return mesh;
}

}  // namespace posefusion::synth
