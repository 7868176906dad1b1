#include <algorithm>
#include <array>
#include <cmath>

#include "hosts/synth/parallel.hpp"
#include "hosts/synth/random.hpp"
#include "hosts/synth/texture.hpp"

/// The designs: each is a function from metres to an sRGB colour.
namespace posefusion::synth {
namespace {

using Paint = std::function<Vector3f(float, float)>;

float fraction(float x) { return x - std::floor(x); }
std::uint64_t cell(float x) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(x))); }
Vector3f hue(Rng& rng, float low, float high) {
    return {rng.uniform(low, high), rng.uniform(low, high), rng.uniform(low, high)};
}

constexpr float kFreshContrast = 0.3f;  ///< of a new coat of paint, relative to old plaster

Paint plaster(std::uint64_t seed, const Vector3f& base, float contrast = 1) {
    return [=](float u, float v) -> Vector3f {
        const float grain = 0.10f * (fractal_noise(seed, 9 * u, 9 * v, 4) - 0.5f) +
                            0.07f * (value_noise(seed + 9, 90 * u, 90 * v) - 0.5f);
        return base * (1 + 1.3f * contrast * grain);
    };
}

Paint wallpaper(std::uint64_t seed, const Vector3f& base, const Vector3f& accent) {
    return [=](float u, float v) -> Vector3f {
        const float row = std::floor(v / 0.12f);
        const float x = fraction(u / 0.16f + 0.5f * row) - 0.5f, y = fraction(v / 0.12f) - 0.5f;
        const float angle = std::atan2(y, x), r = std::hypot(x, y);
        const float petals =
            0.26f +
            0.11f * std::cos(5 * angle + static_cast<float>(hash(seed, cell(u / 0.16f + 0.5f * row), cell(row)) % 7));
        const Vector3f color = r < 0.07f ? Vector3f(0.6f * accent) : r < petals ? accent : base;
        return color * (0.95f + 0.10f * fractal_noise(seed, 11 * u, 11 * v, 4));
    };
}

Paint boards(std::uint64_t seed, const Vector3f& base, float width, float length) {
    return [=](float u, float v) -> Vector3f {
        const std::uint64_t column = cell(u / width);
        const float along = v / length + to_uniform(hash(seed, column));
        const std::uint64_t board = hash(seed, column, cell(along));
        const float tone = 0.82f + 0.32f * to_uniform(board);
        const float offset = static_cast<float>(board % 97);
        const float rings = fractal_noise(seed, 60 * u + offset, 3.5f * v + offset, 4);
        const float line = 0.5f + 0.5f * std::sin(38 * rings + 7 * offset);
        const float gap = std::min(fraction(u / width) * width, fraction(along) * length) < 0.004f ? 0.45f : 1.0f;
        return base * (tone * gap * (0.80f + 0.16f * line + 0.12f * rings));
    };
}

Paint wood(std::uint64_t seed, const Vector3f& base) {
    return [=](float u, float v) -> Vector3f {
        const float rings = fractal_noise(seed, 22 * u, 1.6f * v, 4);
        return base * (0.76f + 0.22f * (0.5f + 0.5f * std::sin(55 * rings + 4 * u)) +
                       0.14f * value_noise(seed, 200 * u, 12 * v));
    };
}

Paint carpet(std::uint64_t seed, const Vector3f& base, const Vector3f& accent, const Vector3f& third,
             const Vector2f& span) {
    return [=](float u, float v) -> Vector3f {
        const float edge = std::min({u, v, span.x() - u, span.y() - v});
        const float d = std::abs(fraction(u / 0.30f) - 0.5f) + std::abs(fraction(v / 0.30f) - 0.5f);
        Vector3f color = d < 0.16f ? third : d < 0.34f ? accent : d < 0.39f ? Vector3f(0.5f * accent) : base;
        if (edge < 0.12f) color = fraction((u + v) / 0.08f) < 0.5f ? accent : third;
        if (edge < 0.03f) color = 0.6f * base;
        return color * (0.80f + 0.36f * value_noise(seed, 170 * u, 170 * v));
    };
}

Paint fabric(std::uint64_t seed, const Vector3f& base) {
    return [=](float u, float v) -> Vector3f {
        const float threads = 0.5f + 0.25f * std::sin(700 * u) + 0.25f * std::sin(700 * v);
        return base * (0.78f + 0.12f * threads + 0.28f * fractal_noise(seed, 26 * u, 26 * v, 4));
    };
}

Paint cardboard(std::uint64_t seed) {
    return [=](float u, float v) -> Vector3f {
        Vector3f color(0.70f, 0.54f, 0.37f);
        color *= 0.90f + 0.16f * fractal_noise(seed, 18 * u, 4 * v, 3);
        if (std::abs(fraction(v / 0.42f) - 0.5f) < 0.055f) color = Vector3f(0.80f, 0.70f, 0.52f);  // tape
        const float x = fraction(u / 0.42f), y = fraction(v / 0.42f);
        if (x > 0.12f && x < 0.42f && y > 0.10f && y < 0.34f)
            color = value_noise(seed + 3, 130 * u, 60 * v) > 0.55f ? Vector3f(0.16f, 0.16f, 0.18f)
                                                                   : Vector3f(0.90f, 0.90f, 0.87f);
        return color;
    };
}

Paint book_spine(std::uint64_t seed) {
    // White on black scale: the tint of each book colours it. Titles run along the spine.
    return [=](float u, float v) -> Vector3f {
        const float tone = 0.84f + 0.10f * value_noise(seed, 40 * u, 40 * v);
        const bool band = fraction(v / 0.28f + 0.09f) < 0.05f || fraction(v / 0.28f + 0.36f) < 0.03f;
        const bool title = fraction(v / 0.28f) > 0.25f && fraction(v / 0.28f) < 0.72f &&
                           value_noise(seed + cell(u / 0.05f), 110 * u, 190 * v) > 0.62f;
        const float value = title ? 0.22f : band ? 0.40f : tone;
        return {value, value, value};
    };
}

Paint screen(std::uint64_t seed) {
    return [=](float u, float v) -> Vector3f {
        if (v < 0.025f) return {0.22f, 0.25f, 0.32f};
        const float row = std::floor(v / 0.018f);
        const float indent = 0.03f + 0.03f * static_cast<float>(hash(seed, cell(row)) % 4);
        const float length = 0.06f + 0.25f * to_uniform(hash(seed, cell(row), 1));
        const bool text =
            u > indent && u < indent + length && fraction(v / 0.018f) > 0.3f && value_noise(seed, 260 * u, row) > 0.35f;
        if (u > 0.40f)
            return value_noise(seed, 30 * u, 30 * v) > 0.5f ? Vector3f(0.30f, 0.48f, 0.62f)
                                                            : Vector3f(0.56f, 0.60f, 0.50f);
        return text ? Vector3f(0.70f, 0.78f, 0.72f) : Vector3f(0.09f, 0.10f, 0.13f);
    };
}

Paint keyboard() {
    return [](float u, float v) -> Vector3f {
        const bool key = fraction(u / 0.019f) > 0.15f && fraction(v / 0.019f) > 0.15f;
        return key ? Vector3f(0.24f, 0.24f, 0.26f) : Vector3f(0.08f, 0.08f, 0.09f);
    };
}

Paint window_view(std::uint64_t seed) {
    return [=](float u, float v) -> Vector3f {
        Vector3f color = Vector3f(0.78f, 0.87f, 0.96f) - 0.10f * Vector3f(1, 0.6f, 0) * (1 - v);
        color += Vector3f::Constant(0.16f * smoothstep(0.45f, 0.75f, fractal_noise(seed, 3 * u, 5 * v, 4)));
        const float skyline = 0.62f + 0.22f * to_uniform(hash(seed, cell(u / 0.23f)));
        if (v > skyline) {  // houses
            const bool pane = fraction(u / 0.06f) > 0.45f && fraction(v / 0.09f) > 0.5f;
            color = (pane ? Vector3f(0.40f, 0.46f, 0.52f) : Vector3f(0.74f, 0.66f, 0.58f)) *
                    (0.8f + 0.3f * to_uniform(hash(seed, cell(u / 0.23f), 5)));
        }
        if (v > 0.86f + 0.16f * fractal_noise(seed + 4, 7 * u, 1, 3))
            color = Vector3f(0.34f, 0.46f, 0.26f) * (0.6f + 0.8f * fractal_noise(seed, 30 * u, 30 * v, 3));
        return color;
    };
}

Paint curtain(std::uint64_t seed, const Vector3f& base) {
    return [=](float u, float v) -> Vector3f {
        const float fold = 0.5f + 0.5f * std::sin(55 * u + 3 * fractal_noise(seed, 4 * u, v, 2));
        const bool dot = std::hypot(fraction(u / 0.11f) - 0.5f, fraction(v / 0.11f) - 0.5f) < 0.18f;
        return (dot ? Vector3f(0.55f * base + Vector3f::Constant(0.35f)) : base) * (0.68f + 0.36f * fold);
    };
}

Paint leaf(std::uint64_t seed) {
    return [=](float u, float v) -> Vector3f {
        const float vein =
            std::abs(u - 0.05f) < 0.003f || fraction((v + std::abs(u - 0.05f)) / 0.03f) < 0.12f ? 1.35f : 1.0f;
        return Vector3f(0.20f, 0.42f, 0.16f) * (vein * (0.75f + 0.5f * fractal_noise(seed, 30 * u, 30 * v, 2)));
    };
}

Paint door(std::uint64_t seed, const Vector3f& base) {
    const Paint grain = wood(seed, base);
    return [=](float u, float v) -> Vector3f {
        const float x = fraction(u / 0.45f), y = fraction(v / 1.0f);
        const bool groove =
            x > 0.12f && x < 0.88f && y > 0.10f && y < 0.90f && (x < 0.16f || x > 0.84f || y < 0.12f || y > 0.88f);
        return (groove ? 0.6f : 1.0f) * grain(u, v);
    };
}

/// Four kinds of picture: mountains, abstract, typographic, portrait-free still life.
Paint poster(int kind, std::uint64_t seed) {
    Rng rng(seed);
    const Vector3f a = hue(rng, 0.15f, 0.95f), b = hue(rng, 0.15f, 0.95f), c = hue(rng, 0.05f, 0.6f);
    return [=](float u, float v) -> Vector3f {
        const float x = u / 0.6f, y = v / 0.8f;
        if (std::min({x, y, 1 - x, 1 - y}) < 0.035f) return {0.16f, 0.13f, 0.11f};  // frame
        if (std::min({x, y, 1 - x, 1 - y}) < 0.075f) return {0.93f, 0.92f, 0.88f};
        switch (kind) {
            case 0: {
                Vector3f color = (1 - y) * Vector3f(0.45f, 0.62f, 0.85f) + y * Vector3f(0.95f, 0.76f, 0.55f);
                for (int layer = 0; layer < 4; ++layer) {
                    const auto l = static_cast<float>(layer);
                    const float ridge =
                        0.32f + 0.15f * l +
                        0.22f * (fractal_noise(seed + static_cast<std::uint64_t>(layer), 4 * x, 0.5f + l, 4) - 0.5f);
                    if (y > ridge) color = (0.72f - 0.16f * l) * a + (0.05f + 0.03f * l) * Vector3f::Ones();
                }
                return color * (0.9f + 0.2f * value_noise(seed, 70 * x, 70 * y));
            }
            case 1: {
                Vector3f color = 0.4f * Vector3f::Ones() + 0.5f * a;
                for (std::uint64_t i = 0; i < 9; ++i) {
                    const float px = to_uniform(hash(seed, i, 1)), py = to_uniform(hash(seed, i, 2)),
                                r = 0.07f + 0.17f * to_uniform(hash(seed, i, 3));
                    if (std::hypot(x - px, y - py) < r)
                        color = i % 3 == 0 ? b : i % 3 == 1 ? c : Vector3f(0.5f * (a + c));
                }
                return color;
            }
            case 2: {
                const float row = std::floor(y / 0.07f);
                const float size = hash(seed, cell(row)) % 3 == 0 ? 14.0f : 34.0f;
                const bool ink = fraction(y / 0.07f) > 0.25f && value_noise(seed, size * x, 40 * y + 7 * row) > 0.52f &&
                                 x > 0.14f && x < 0.86f;
                return ink ? c : Vector3f(0.92f, 0.90f, 0.82f);
            }
            default: {
                Vector3f color =
                    y > 0.66f ? Vector3f(0.48f, 0.34f, 0.22f) : Vector3f(0.7f * b + 0.2f * Vector3f::Ones());
                const std::array<Vector2f, 4> fruit{{{0.35f, 0.60f}, {0.52f, 0.58f}, {0.67f, 0.62f}, {0.45f, 0.46f}}};
                for (std::size_t i = 0; i < fruit.size(); ++i) {
                    const float d = std::hypot(x - fruit[i].x(), 1.3f * (y - fruit[i].y())) / 0.11f;
                    if (d < 1) color = (i % 2 ? a : Vector3f(0.86f, 0.42f, 0.16f)) * (1.1f - 0.55f * d);
                }
                return color * (0.86f + 0.28f * fractal_noise(seed, 24 * x, 24 * y, 3));
            }
        }
    };
}

/// Patches of all colours around scattered points, with a grain.
Paint motley(std::uint64_t seed, const Vector2f& span) {
    constexpr float kPatch = 0.055f;  // metres
    return [=](float u, float v) -> Vector3f {
        const float columns = std::round(span.x() / kPatch), rows = std::round(span.y() / kPatch);
        const float x = u / span.x() * columns, y = v / span.y() * rows;
        float nearest = 9;
        std::uint64_t patch = 0;
        for (int dy = -1; dy <= 1; ++dy)
            for (int dx = -1; dx <= 1; ++dx) {
                const float i = std::floor(x) + static_cast<float>(dx), j = std::floor(y) + static_cast<float>(dy);
                const std::uint64_t id =
                    hash(seed, cell(fraction(i / columns) * columns + 0.5f), cell(fraction(j / rows) * rows + 0.5f));
                const float distance = std::hypot(i + to_uniform(mix(id)) - x, j + to_uniform(mix(id + 1)) - y);
                if (distance < nearest) nearest = distance, patch = id;
            }
        const Vector3f color(to_uniform(hash(patch, 1)), to_uniform(hash(patch, 2)), to_uniform(hash(patch, 3)));
        return Vector3f(0.12f * Vector3f::Ones() + 0.8f * color) * (0.85f + 0.3f * value_noise(seed, 90 * u, 90 * v));
    };
}

/// Scenes of a film side by side: skies, hills and bright shapes.
Paint film(std::uint64_t seed, const Vector2f& span) {
    return [=](float u, float v) -> Vector3f {
        const float x = u / span.x(), y = fraction(2 * v / span.y()), wave = 2 * kPi * x;
        const std::uint64_t scene = hash(seed, cell(2 * v / span.y()));
        const Vector3f sky(to_uniform(hash(scene, 1)), to_uniform(hash(scene, 2)), to_uniform(hash(scene, 3)));
        const Vector3f ground(to_uniform(hash(scene, 4)), to_uniform(hash(scene, 5)), to_uniform(hash(scene, 6)));
        Vector3f color = (0.25f + 0.7f * (1 - y)) * sky;
        const float hills = 0.55f + 0.14f * std::sin(3 * wave + to_uniform(scene) * 6) + 0.06f * std::sin(11 * wave);
        if (y > hills) color = (0.35f + 0.4f * value_noise(scene, 30 * u, 30 * v)) * ground;
        for (std::uint64_t i = 0; i < 14; ++i) {
            const float px = to_uniform(hash(scene, i, 7)), py = 0.15f + 0.7f * to_uniform(hash(scene, i, 8));
            const float across = std::abs(fraction(x - px + 0.5f) - 0.5f) * span.x(), down = (y - py) * 0.5f * span.y();
            if (std::hypot(across, down) < 0.03f + 0.06f * to_uniform(hash(scene, i, 9)))
                color = Vector3f(to_uniform(hash(scene, i, 10)), to_uniform(hash(scene, i, 11)),
                                 to_uniform(hash(scene, i, 12)));
        }
        return color;
    };
}

struct Recipe {
    Vector2f span;
    int pixels_per_metre;
    Paint paint;
    bool emits;
};

Paint flat(const Vector3f& color) {
    return [=](float, float) { return color; };
}

}  // namespace

std::vector<Texture> paint_textures(std::uint64_t seed, int threads) {
    Rng rng(seed);
    const std::array<Vector3f, 4> walls{Vector3f(0.84f, 0.81f, 0.74f), Vector3f(0.72f, 0.78f, 0.78f),
                                        Vector3f(0.82f, 0.76f, 0.68f), Vector3f(0.74f, 0.79f, 0.70f)};
    const std::array<Vector3f, 3> floors{Vector3f(0.62f, 0.45f, 0.30f), Vector3f(0.72f, 0.58f, 0.42f),
                                         Vector3f(0.48f, 0.35f, 0.25f)};
    const std::array<Vector3f, 3> fabrics{Vector3f(0.42f, 0.50f, 0.60f), Vector3f(0.58f, 0.36f, 0.30f),
                                          Vector3f(0.46f, 0.52f, 0.40f)};
    const Vector3f& wall = walls[static_cast<std::size_t>(rng.index(4))];
    const Vector3f accent = 0.82f * wall + 0.04f * hue(rng, 0, 1);
    const Vector3f& floor = floors[static_cast<std::size_t>(rng.index(3))];
    const Vector3f& cloth = fabrics[static_cast<std::size_t>(rng.index(3))];
    const Vector2f rug(2.4f, 1.8f), picture(0.6f, 0.8f);
    const Vector3f rug_a = hue(rng, 0.25f, 0.6f), rug_b = hue(rng, 0.4f, 0.85f), rug_c = hue(rng, 0.1f, 0.5f);
    std::vector<Recipe> recipes;
    const auto add = [&](const Vector2f& span, int pixels_per_metre, const Paint& paint, bool emits = false) {
        recipes.push_back({span, pixels_per_metre, paint, emits});
    };
    add({0.1f, 0.1f}, 20, flat({0.95f, 0.95f, 0.95f}));                    // Plain
    add({2.56f, 2.56f}, 200, plaster(rng.seed(), wall));                   // Plaster
    add({1.28f, 1.2f}, 300, wallpaper(rng.seed(), wall, accent));          // Wallpaper
    add({1.92f, 2.56f}, 250, boards(rng.seed(), floor, 0.16f, 1.28f));     // FloorBoards
    add({1.28f, 1.28f}, 100, plaster(rng.seed(), {0.93f, 0.93f, 0.92f}));  // Ceiling
    add(rug, 250, carpet(rng.seed(), rug_a, rug_b, rug_c, rug));           // Carpet
    add({0.64f, 1.28f}, 400, wood(rng.seed(), {0.66f, 0.48f, 0.31f}));     // Wood
    add({0.64f, 1.28f}, 400, wood(rng.seed(), {0.40f, 0.27f, 0.18f}));     // DarkWood
    add({0.64f, 0.64f}, 400, fabric(rng.seed(), cloth));                   // Fabric
    add({0.84f, 0.84f}, 300, cardboard(rng.seed()));                       // Cardboard
    add({0.64f, 0.28f}, 700, book_spine(rng.seed()));                      // BookSpine
    add({0.56f, 0.34f}, 500, screen(rng.seed()), true);                    // Screen
    add({0.38f, 0.133f}, 400, keyboard());                                 // Keyboard
    add({1.2f, 1.2f}, 250, window_view(rng.seed()), true);                 // WindowView
    add({0.66f, 0.66f}, 250, curtain(rng.seed(), hue(rng, 0.45f, 0.8f)));  // Curtain
    add({0.1f, 0.3f}, 500, leaf(rng.seed()));                              // Leaf
    add({0.3f, 0.3f}, 200, plaster(rng.seed(), {0.20f, 0.15f, 0.11f}));    // Soil
    add({0.3f, 0.3f}, 200, plaster(rng.seed(), {0.34f, 0.35f, 0.37f}));    // Metal
    add({0.1f, 0.1f}, 20, flat({1, 0.98f, 0.93f}), true);                  // LampGlow
    const Paint page = poster(2, rng.seed());
    add({0.3f, 0.42f}, 500, [page](float u, float v) { return page(2 * u, v / 0.525f); });  // Paper
    add({0.28f, 0.12f}, 400, [](float u, float v) -> Vector3f {                             // CeramicBand
        const bool band = v > 0.03f && v < 0.06f && fraction(u / 0.02f) < 0.5f;
        return band ? Vector3f(0.2f, 0.3f, 0.55f) : Vector3f(0.92f, 0.92f, 0.90f);
    });
    add({0.9f, 2.0f}, 250, door(rng.seed(), {0.78f, 0.70f, 0.58f}));  // Door
    for (int kind = 0; kind < kPosterCount; ++kind) add(picture, 500, poster(kind, rng.seed()));
    add({2.56f, 2.56f}, 200, plaster(rng.seed(), wall, kFreshContrast));  // FreshPaint
    const Vector2f patches(0.33f, 0.66f), reel(2.0f, 2.4f);
    add(patches, 400, motley(rng.seed(), patches));  // Motley
    add(reel, 250, film(rng.seed(), reel), true);    // Film
    std::vector<Texture> all(recipes.size());
    parallel_for(static_cast<int>(recipes.size()), threads, [&](int i) {
        const Recipe& r = recipes[static_cast<std::size_t>(i)];
        all[static_cast<std::size_t>(i)] = Texture(r.span, r.pixels_per_metre, r.paint, r.emits);
    });
    return all;
}

}  // namespace posefusion::synth
