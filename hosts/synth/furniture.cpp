#include "hosts/synth/furniture.hpp"

#include <algorithm>
#include <cmath>

namespace posefusion::synth {
namespace {

Vector3f book_tint(Rng& rng) {
    const Vector3f c(rng.uniform(0.04f, 0.9f), rng.uniform(0.04f, 0.7f), rng.uniform(0.04f, 0.7f));
    return rng.chance(0.25f) ? Vector3f(0.3f * c + Vector3f::Constant(0.6f)) : c;
}

/// Books side by side from x0 to x1 on a board at height z, standing `depth` behind the front edge y = 0 of the frame.
void add_books(const MeshBuilder& at, Rng& rng, float x0, float x1, float z, float depth, float headroom) {
    float x = x0;
    while (true) {
        const float thick = rng.uniform(0.018f, 0.055f), tall = std::min(rng.uniform(0.17f, 0.29f), headroom);
        if (x + thick > x1) return;
        const float inset = rng.uniform(0.0f, 0.04f), deep = rng.uniform(0.6f, 0.9f) * depth;
        at.box({x, inset, z}, {x + thick - 0.002f, inset + deep, z + tall}, BookSpine, book_tint(rng),
               {rng.uniform(0, 0.6f), 0});
        x += thick;
        if (rng.chance(0.07f)) x += rng.uniform(0.03f, 0.16f);
    }
}

void add_book_pile(const MeshBuilder& at, Rng& rng, int count) {
    float z = 0;
    for (int i = 0; i < count; ++i) {
        const float w = rng.uniform(0.08f, 0.12f), d = rng.uniform(0.10f, 0.15f), h = rng.uniform(0.02f, 0.045f);
        at.at({0, 0, z}, rng.uniform(-0.4f, 0.4f))
            .box({-w, -d, 0}, {w, d, h}, BookSpine, book_tint(rng), {rng.uniform(0, 0.6f), 0});
        z += h;
    }
}

void add_mug(const MeshBuilder& at, const Vector3f& tint) {
    at.lathe({{0.0f, 0.0f}, {0.036f, 0.0f}, {0.040f, 0.095f}, {0.034f, 0.095f}, {0.030f, 0.01f}, {0.0f, 0.01f}},
             CeramicBand, tint, 16);
}

void add_vase(const MeshBuilder& at, Rng& rng) {
    const float s = rng.uniform(0.8f, 1.3f);
    const Vector3f tint(rng.uniform(0.2f, 0.9f), rng.uniform(0.2f, 0.9f), rng.uniform(0.2f, 0.9f));
    at.lathe({{0, 0},
              {0.05f * s, 0},
              {0.085f * s, 0.07f * s},
              {0.080f * s, 0.13f * s},
              {0.035f * s, 0.21f * s},
              {0.045f * s, 0.25f * s}},
             CeramicBand, tint);
}

void add_laptop(const MeshBuilder& at) {
    at.box({-0.17f, -0.12f, 0}, {0.17f, 0.12f, 0.018f}, Metal);
    at.quad({-0.15f, 0.06f, 0.0185f}, {0.30f, 0, 0}, {0, -0.12f, 0}, Keyboard);
    const Vector3f up(0, 0.08f, 0.22f);
    const Vector3f corner = Vector3f(-0.17f, 0.12f, 0.02f) + up;
    at.quad(corner, {0.34f, 0, 0}, -up, Screen);
    at.quad(corner + Vector3f(0.34f, 0.012f, 0), {-0.34f, 0, 0}, -up, Metal);
}

}  // namespace

void add_bookshelf(const MeshBuilder& at, Rng& rng, float width, float height, float depth) {
    const float w = 0.5f * width, board = 0.024f;
    const Material wood = rng.chance(0.5f) ? Wood : DarkWood;
    at.box({-w, -depth, 0}, {-w + board, 0, height}, wood);
    at.box({w - board, -depth, 0}, {w, 0, height}, wood);
    at.box({-w, -0.01f, 0}, {w, 0, height}, wood);
    const int levels = static_cast<int>(height / 0.34f);
    const float pitch = (height - board - 0.06f) / static_cast<float>(levels);
    for (int i = 0; i <= levels; ++i) {
        const float z = 0.06f + pitch * static_cast<float>(i);
        at.box({-w + board, -depth, z}, {w - board, -0.01f, z + board}, wood);
        if (i == levels) break;
        const MeshBuilder shelf = at.at({0, -depth, 0});
        if (rng.chance(0.2f)) {
            add_vase(shelf.at({rng.uniform(-0.2f, 0.2f), 0.14f, z + board}), rng);
            add_books(shelf, rng, 0.22f, w - board, z + board, depth, pitch - board - 0.02f);
        } else {
            add_books(shelf, rng, -w + board + rng.uniform(0, 0.1f), w - board - rng.uniform(0, 0.15f), z + board,
                      depth, pitch - board - 0.02f);
        }
    }
}

void add_table(const MeshBuilder& at, Rng& rng, float width, float depth) {
    const float w = 0.5f * width, d = 0.5f * depth, top = kTableHeight;
    at.box({-w, -d, top - 0.035f}, {w, d, top}, Wood);
    at.box({-w + 0.06f, -d + 0.06f, top - 0.11f}, {w - 0.06f, d - 0.06f, top - 0.035f}, Wood);
    for (const float x : {-w + 0.07f, w - 0.07f})
        for (const float y : {-d + 0.07f, d - 0.07f})
            at.box({x - 0.03f, y - 0.03f, 0}, {x + 0.03f, y + 0.03f, top - 0.035f}, Wood);
    const MeshBuilder on = at.at({0, 0, top});
    add_laptop(on.at({rng.uniform(-0.35f, -0.15f), rng.uniform(-0.08f, 0.08f), 0}, rng.uniform(-0.6f, 0.6f)));
    add_mug(on.at({rng.uniform(0.0f, 0.1f), rng.uniform(-0.25f, 0.1f), 0}), {0.9f, 0.85f, 0.8f});
    add_mug(on.at({rng.uniform(0.35f, 0.45f), rng.uniform(-0.1f, 0.25f), 0}), {0.5f, 0.6f, 0.8f});
    add_book_pile(on.at({rng.uniform(0.2f, 0.3f), rng.uniform(-0.15f, 0.1f), 0}), rng, 2 + rng.index(4));
    for (int i = 0; i < 2; ++i) {
        const MeshBuilder sheet =
            on.at({rng.uniform(-0.1f, 0.3f), rng.uniform(-0.25f, 0.2f), 0.002f}, rng.uniform(-0.8f, 0.8f));
        sheet.quad({-0.105f, 0.148f, 0}, {0.21f, 0, 0}, {0, -0.297f, 0}, Paper);
    }
    on.at({-0.45f, 0.2f, 0})
        .lathe({{0, 0}, {0.05f, 0}, {0.13f, 0.06f}, {0.125f, 0.06f}, {0.05f, 0.01f}, {0, 0.01f}}, CeramicBand);
}

void add_chair(const MeshBuilder& at, Rng& rng) {
    const Material wood = rng.chance(0.5f) ? Wood : DarkWood;
    const float seat = kSeatHeight;
    for (const float x : {-0.19f, 0.19f}) {
        at.box({x - 0.018f, -0.20f, 0}, {x + 0.018f, -0.164f, seat - 0.04f}, wood);
        at.box({x - 0.018f, 0.18f, 0}, {x + 0.018f, 0.216f, 0.90f}, wood);
    }
    at.box({-0.215f, -0.22f, seat - 0.05f}, {0.215f, 0.21f, seat - 0.02f}, wood);
    at.box({-0.205f, -0.21f, seat - 0.02f}, {0.205f, 0.175f, seat}, Fabric);
    for (const float z : {0.58f, 0.69f, 0.80f}) at.box({-0.19f, 0.188f, z}, {0.19f, 0.206f, z + 0.07f}, wood);
}

void add_sofa(const MeshBuilder& at, Rng& rng, float width, float depth) {
    const float w = 0.5f * width;
    at.box({-w, -depth, 0.06f}, {w, -0.02f, 0.30f}, Fabric, Vector3f::Constant(0.85f));
    at.box({-w + 0.16f, -0.24f, 0.30f}, {w - 0.16f, -0.02f, 0.82f}, Fabric, Vector3f::Constant(0.95f));
    for (const float x : {-w, w - 0.17f})
        at.box({x, -depth, 0.30f}, {x + 0.17f, -0.02f, 0.60f}, Fabric, Vector3f::Constant(0.9f));
    const float half = w - 0.17f;
    for (const float x : {-half, 0.01f})
        at.box({x, -depth - 0.01f, 0.30f}, {x + half - 0.01f, -0.24f, 0.44f}, Fabric, Vector3f::Ones(), {x + 1, 0});
    for (int i = 0; i < 3; ++i) {
        const Vector3f tint(rng.uniform(0.6f, 1.9f), rng.uniform(0.5f, 1.5f), rng.uniform(0.4f, 1.3f));
        Eigen::Isometry3f lean = Eigen::Isometry3f::Identity();
        lean.linear() = (Eigen::AngleAxisf(rng.uniform(-0.3f, 0.3f), Vector3f::UnitZ()) *
                         Eigen::AngleAxisf(-0.35f, Vector3f::UnitX()))
                            .toRotationMatrix();
        lean.translation() =
            Vector3f(-half + 0.28f + rng.uniform(0.0f, 0.16f) + 0.48f * static_cast<float>(i), -0.36f, 0.45f);
        at.at(lean).box({-0.2f, -0.06f, 0}, {0.2f, 0.06f, 0.36f}, i == 1 ? Curtain : Fabric, tint.cwiseMin(1.2f));
    }
}

void add_desk(const MeshBuilder& at, Rng& rng, float width, float depth) {
    const float w = 0.5f * width, top = kTableHeight;
    at.box({-w, -depth, top - 0.03f}, {w, 0, top}, DarkWood);
    at.box({-w, -depth + 0.02f, 0}, {-w + 0.03f, 0, top - 0.03f}, DarkWood);
    at.box({w - 0.42f, -depth + 0.02f, 0}, {w, 0, top - 0.03f}, DarkWood);
    for (const float z : {0.08f, 0.30f, 0.52f}) {
        at.box({w - 0.40f, -depth, z}, {w - 0.02f, -depth + 0.02f, z + 0.18f}, Wood);
        at.box({w - 0.25f, -depth - 0.02f, z + 0.08f}, {w - 0.17f, -depth, z + 0.095f}, Metal);
    }
    const MeshBuilder on = at.at({0, 0, top});
    on.box({-0.10f, -0.30f, 0}, {0.10f, -0.14f, 0.015f}, Metal);
    on.box({-0.02f, -0.22f, 0}, {0.02f, -0.20f, 0.16f}, Metal);
    on.box({-0.30f, -0.23f, 0.12f}, {0.30f, -0.205f, 0.50f}, Metal, Vector3f::Constant(0.4f));
    on.quad({-0.28f, -0.2305f, 0.48f}, {0.56f, 0, 0}, {0, 0, -0.34f}, Screen);
    on.box({-0.21f, -0.54f, 0}, {0.17f, -0.407f, 0.015f}, Metal);
    on.quad({-0.21f, -0.407f, 0.0155f}, {0.38f, 0, 0}, {0, -0.133f, 0}, Keyboard);
    add_book_pile(on.at({0.42f, -0.25f, 0}, 0.2f), rng, 3 + rng.index(3));
    add_mug(on.at({-0.40f, -0.35f, 0}), {0.8f, 0.4f, 0.3f});
    add_books(on.at({0, -0.22f, 0}), rng, -w + 0.02f, -0.36f, 0, 0.2f, 0.3f);
}

void add_sideboard(const MeshBuilder& at, Rng& rng, float width, float height, float depth) {
    const float w = 0.5f * width;
    at.box({-w, -depth, 0.08f}, {w, 0, height}, DarkWood);
    at.box({-w + 0.03f, -depth + 0.03f, 0}, {w - 0.03f, -0.03f, 0.08f}, DarkWood, Vector3f::Constant(0.4f));
    const int doors = 3;
    const float pitch = width / static_cast<float>(doors);
    for (int i = 0; i < doors; ++i) {
        const float x = -w + pitch * static_cast<float>(i);
        at.box({x + 0.015f, -depth - 0.018f, 0.11f}, {x + pitch - 0.015f, -depth, height - 0.04f}, Wood,
               Vector3f::Ones(), {0.2f * static_cast<float>(i), 0});
        at.box({x + pitch - 0.07f, -depth - 0.04f, 0.5f * height},
               {x + pitch - 0.05f, -depth - 0.018f, 0.5f * height + 0.1f}, Metal);
    }
    const MeshBuilder on = at.at({0, 0, height});
    add_vase(on.at({-w + 0.2f, -0.2f, 0}), rng);
    add_books(on.at({0, -0.28f, 0}), rng, -0.25f, 0.15f + rng.uniform(0.0f, 0.2f), 0, 0.2f, 0.3f);
    add_book_pile(on.at({w - 0.2f, -0.2f, 0}, rng.uniform(-0.3f, 0.3f)), rng, 2 + rng.index(3));
}

void add_plant(const MeshBuilder& at, Rng& rng, float height) {
    at.lathe({{0, 0}, {0.12f, 0}, {0.17f, 0.30f}, {0.15f, 0.30f}, {0.14f, 0.27f}}, CeramicBand, {0.75f, 0.45f, 0.32f});
    at.lathe({{0.145f, 0.27f}, {0.0f, 0.275f}}, Soil);
    for (int i = 0; i < 26; ++i) {
        const float yaw = rng.uniform(0, 2 * kPi), rise = rng.uniform(0.35f, 1.0f) * (height - 0.3f),
                    reach = rng.uniform(0.12f, 0.34f);
        const Vector3f out(std::cos(yaw), std::sin(yaw), 0), side(-std::sin(yaw), std::cos(yaw), 0);
        std::vector<Vector3f> curve;
        for (int k = 0; k <= 6; ++k) {
            const float t = static_cast<float>(k) / 6;
            curve.push_back(out * (reach * t * t + 0.02f) + Vector3f(0, 0, 0.27f + rise * (t - 0.35f * t * t * t)));
        }
        at.ribbon(curve, side, rng.uniform(0.05f, 0.09f), Leaf, Vector3f::Constant(rng.uniform(0.7f, 1.3f)));
    }
}

void add_cartons(const MeshBuilder& at, Rng& rng, int count) {
    float z = 0, scale = 1;
    for (int i = 0; i < count; ++i) {
        const float w = scale * rng.uniform(0.19f, 0.24f), d = scale * rng.uniform(0.16f, 0.22f),
                    h = scale * rng.uniform(0.26f, 0.38f);
        at.at({0, 0, z}, rng.uniform(-0.25f, 0.25f))
            .box({-w, -d, 0}, {w, d, h}, Cardboard, Vector3f::Constant(rng.uniform(0.85f, 1.05f)),
                 {rng.uniform(0, 0.8f), 0});
        z += h;
        scale *= 0.82f;
    }
}

void add_floor_lamp(const MeshBuilder& at) {
    at.lathe({{0, 0}, {0.15f, 0}, {0.15f, 0.02f}, {0.015f, 0.03f}, {0.012f, 1.45f}}, Metal);
    at.lathe({{0.20f, 1.40f}, {0.13f, 1.68f}}, Curtain, {1.1f, 1.05f, 0.9f}, 28);
}

void add_window(const MeshBuilder& at, Rng& rng, float width, float sill, float top) {
    const float w = 0.5f * width;
    at.quad({-w, -0.02f, top}, {width, 0, 0}, {0, 0, sill - top}, WindowView);
    const Vector3f white = Vector3f::Constant(0.9f);
    for (const float x : {-w - 0.05f, -0.03f, w - 0.01f})
        at.box({x, -0.06f, sill - 0.05f}, {x + 0.06f, 0, top + 0.05f}, Plain, white);
    for (const float z : {sill - 0.05f, top - 0.01f})
        at.box({-w - 0.05f, -0.06f, z}, {w + 0.05f, 0, z + 0.06f}, Plain, white);
    at.box({-w - 0.1f, -0.20f, sill - 0.08f}, {w + 0.1f, 0, sill - 0.05f}, Plain, white);
    for (int i = 0; i < 14; ++i) {  // radiator
        const float x = -w + 0.1f + (width - 0.2f) * static_cast<float>(i) / 14;
        at.box({x, -0.13f, 0.15f}, {x + 0.055f, -0.04f, sill - 0.22f}, Plain, white);
    }
    add_mug(at.at({rng.uniform(-0.4f, 0.4f), -0.12f, sill - 0.05f}), {0.9f, 0.8f, 0.5f});
    at.box({-w - 0.45f, -0.10f, top + 0.10f}, {w + 0.45f, -0.08f, top + 0.12f}, Metal);
    for (const float x0 : {-w - 0.38f, w + 0.04f}) {  // pleated curtains
        for (int i = 0; i < 12; ++i) {
            const float step = 0.34f / 12, x = x0 + step * static_cast<float>(i);
            const float y = i % 2 ? -0.12f : -0.07f, next = i % 2 ? -0.07f : -0.12f;
            at.quad({x, y, top + 0.10f}, {step, next - y, 0}, {0, 0, 0.25f - top}, Curtain, Vector3f::Ones(),
                    {0.05f * static_cast<float>(i), 0});
        }
    }
}

void add_poster(const MeshBuilder& at, int kind) {
    const float w = 0.3f, h = 0.4f;
    at.box({-w, -0.025f, -h}, {w, 0, h}, DarkWood, Vector3f::Constant(0.5f));
    at.quad({-w, -0.0255f, h}, {2 * w, 0, 0}, {0, 0, -2 * h}, static_cast<Material>(Poster0 + kind));
}

}  // namespace posefusion::synth
