#include "hosts/synth/body_look.hpp"

#include <array>
#include <cmath>

#include "hosts/synth/random.hpp"

namespace posefusion::synth {
namespace {

float to_linear(float value) {
    const float x = value / 255;
    return x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
}

template <std::size_t N>
Vector3f pick(Rng& rng, const std::array<std::array<float, 3>, N>& colors) {
    const auto& c = colors[static_cast<std::size_t>(rng.index(static_cast<int>(N)))];
    const float vary = rng.uniform(0.92f, 1.06f);
    return linear_rgb(std::min(c[0] * vary, 250.0f), std::min(c[1] * vary, 250.0f), std::min(c[2] * vary, 250.0f));
}

constexpr std::array<std::array<float, 3>, 6> kSkin{
    {{232, 190, 166}, {222, 174, 146}, {205, 155, 122}, {176, 124, 92}, {134, 90, 65}, {98, 66, 49}}};
constexpr std::array<std::array<float, 3>, 5> kLightHair{
    {{60, 42, 30}, {92, 64, 40}, {150, 112, 66}, {38, 30, 26}, {128, 122, 118}}};
constexpr std::array<std::array<float, 3>, 2> kDarkHair{{{30, 24, 22}, {44, 32, 26}}};
constexpr std::array<std::array<float, 3>, 9> kShirt{{{178, 44, 48},
                                                      {38, 84, 148},
                                                      {232, 230, 224},
                                                      {44, 110, 76},
                                                      {214, 160, 52},
                                                      {92, 60, 120},
                                                      {70, 76, 84},
                                                      {150, 190, 214},
                                                      {206, 116, 78}}};
constexpr std::array<std::array<float, 3>, 5> kTrousers{
    {{44, 58, 92}, {36, 38, 44}, {150, 128, 98}, {84, 100, 132}, {78, 72, 62}}};
constexpr std::array<std::array<float, 3>, 4> kShoes{{{40, 34, 32}, {214, 212, 208}, {96, 62, 40}, {52, 62, 84}}};
constexpr std::array<std::array<float, 3>, 3> kIris{{{62, 40, 26}, {70, 96, 120}, {82, 92, 58}}};

/// Cheap wrinkles in cloth: brightness, about 1.
float weave(std::uint64_t seed, const Vector3f& p, float stretch_z) {
    return 0.90f + 0.20f * fractal_noise(seed, 14 * p.y() + 5 * p.x(), stretch_z * p.z() + 9 * p.x(), 3);
}

Vector3f face_albedo(const BodyLook& look, const Vector3f& p) {
    // Head frame in units of the stature: x ahead, y left, z up.
    const float y = std::abs(p.y()), z = p.z();
    Vector3f color = look.skin * (0.95f + 0.08f * fractal_noise(look.seed, 160 * p.y(), 160 * z, 2));
    if (p.x() < 0.026f) return color;
    const float blush = std::exp(-(std::pow((y - 0.026f) / 0.011f, 2.0f) + std::pow((z - 0.022f) / 0.010f, 2.0f)));
    color = color.cwiseProduct(Vector3f(1 + 0.10f * blush, 1 - 0.06f * blush, 1 - 0.06f * blush));
    if (look.beard) {
        const float jaw = smoothstep(0.022f, 0.010f, z - 0.35f * y) * smoothstep(-0.03f, 0.0f, p.x());
        color = color * (1 - 0.72f * jaw) + look.hair_color * (0.72f * jaw);
    }
    const float lips = std::pow(y / 0.0165f, 2.0f) + std::pow((z - 0.006f) / 0.0046f, 2.0f);
    if (lips < 1) {
        const Vector3f red =
            look.skin.cwiseProduct(look.woman ? Vector3f(0.88f, 0.42f, 0.44f) : Vector3f(0.80f, 0.58f, 0.56f));
        color = std::abs(z - 0.006f - 0.02f * y) < 0.0008f ? Vector3f(0.35f * red) : red;
    }
    const float eye_y = (y - 0.018f) / 0.0098f, eye_z = (z - 0.0475f) / 0.0046f;
    const float eye = eye_y * eye_y + eye_z * eye_z;
    if (eye < 1) {
        const float iris = std::hypot(y - 0.018f, z - 0.0478f);
        color = iris < 0.0020f   ? Vector3f(0.01f, 0.01f, 0.01f)
                : iris < 0.0046f ? look.iris
                                 : Vector3f(0.52f, 0.49f, 0.46f);
        if (eye_z > 0.45f) color *= 0.25f;  // lashes
    } else if (eye < 2.4f) {
        color *= eye_z > 0 ? 0.62f : 0.85f;  // lid and socket
    }
    const float brow = z - 0.0605f + 0.9f * std::pow(std::max(y - 0.02f, 0.0f), 2.0f) * 20;
    if (y > 0.007f && y < 0.030f && std::abs(brow) < 0.0026f) color = 0.25f * color + 0.75f * look.hair_color;
    if (p.x() > 0.062f && z < 0.0205f && y < 0.009f && y > 0.002f) color *= 0.45f;  // nostrils
    return color;
}

Vector3f shirt_albedo(const BodyLook& look, const Vector3f& p) {
    Vector3f color = look.shirt;
    const float h = look.height;
    switch (look.pattern) {
        case Pattern::Plain:
            break;
        case Pattern::Stripes:
            if (p.z() / 0.07f - std::floor(p.z() / 0.07f) < 0.35f) color = look.shirt_accent;
            break;
        case Pattern::Checks: {
            const auto band = [](float x) { return x - std::floor(x) < 0.4f ? 1.0f : 0.0f; };
            const float amount = 0.5f * (band(p.z() / 0.06f) + band((p.y() + 0.3f * p.x()) / 0.06f));
            color = color * (1 - amount) + look.shirt_accent * amount;
            break;
        }
        case Pattern::Print:
            if (p.x() > 0 && std::hypot(p.y() / 0.085f, (p.z() - 0.70f * h) / 0.055f) < 1) {
                color = fractal_noise(look.seed, 40 * p.y(), 40 * p.z(), 2) > 0.5f ? look.shirt_accent
                                                                                   : Vector3f(0.8f * look.shirt);
            }
            break;
    }
    if (std::hypot(p.x(), p.y()) < 0.052f * h && p.z() > 0.80f * h)
        color = 0.6f * look.shirt_accent + 0.2f * look.shirt;                        // collar
    if (p.x() > 0 && std::abs(p.y()) < 0.004f && look.long_sleeves) color *= 0.45f;  // front seam
    return color * weave(look.seed, p, 7);
}

Vector3f trousers_albedo(const BodyLook& look, const Vector3f& p) {
    const float h = look.height;
    Vector3f color = look.trousers * weave(look.seed + 7, p, 5);
    if (p.z() > 0.545f * h) return Vector3f(0.05f, 0.035f, 0.025f);  // belt
    const float leg = std::abs(p.y()) - 0.053f * h;
    if (std::abs(leg - 0.05f * h) < 0.003f && std::abs(p.x()) < 0.03f) color *= 0.6f;  // outer seam
    if (p.x() < 0 && std::abs(std::hypot(leg, p.z() - 0.475f * h) - 0.036f * h) < 0.0035f)
        color *= 0.6f;                                                                              // back pockets
    if (p.x() > 0) color *= 1.0f + 0.25f * std::exp(-std::pow((p.z() - 0.33f * h) / 0.12f, 2.0f));  // faded thighs
    return color;
}

}  // namespace

Vector3f linear_rgb(float r, float g, float b) { return {to_linear(r), to_linear(g), to_linear(b)}; }

BodyLook::BodyLook(std::uint64_t person_seed, bool is_woman) : seed(mix(person_seed)), woman(is_woman) {
    Rng rng(seed);
    height = woman ? rng.uniform(1.58f, 1.74f) : rng.uniform(1.68f, 1.88f);
    girth = rng.uniform(0.96f, 1.14f);
    long_sleeves = rng.chance(0.5f);
    beard = !woman && rng.chance(0.35f);
    hair = woman ? (rng.chance(0.65f) ? Hair::Long : Hair::Bun) : Hair::Short;
    pattern = static_cast<Pattern>(rng.index(4));
    skin = pick(rng, kSkin);
    hair_color = skin.x() < linear_rgb(190, 0, 0).x() ? pick(rng, kDarkHair) : pick(rng, kLightHair);
    shirt = pick(rng, kShirt);
    do shirt_accent = pick(rng, kShirt);
    while ((shirt_accent - shirt).norm() < 0.15f);
    trousers = pick(rng, kTrousers);
    shoes = pick(rng, kShoes);
    iris = pick(rng, kIris);
}

Vector3f body_albedo(const BodyLook& look, float head_joint_height, Layer layer, const Vector3f& rest) {
    switch (layer) {
        case Layer::Head:
            return face_albedo(look, (rest - Vector3f(0, 0, head_joint_height)) / look.height);
        case Layer::Arms:
            return look.skin * (0.95f + 0.08f * fractal_noise(look.seed, 50 * rest.y(), 50 * rest.z(), 2));
        case Layer::Shirt:
            return shirt_albedo(look, rest);
        case Layer::Trousers:
            return trousers_albedo(look, rest);
        case Layer::Shoes:
            return rest.z() < 0.012f ? linear_rgb(200, 196, 188) : look.shoes;
        case Layer::Hair:
            return look.hair_color * (0.6f + 0.8f * fractal_noise(look.seed, 260 * rest.y() + 60 * rest.x(),
                                                                  25 * rest.z() + 120 * rest.x(), 2));
    }
    return look.skin;
}

}  // namespace posefusion::synth
