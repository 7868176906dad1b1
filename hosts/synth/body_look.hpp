#pragma once
#include <cstdint>

#include "hosts/synth/mesh.hpp"

/// What a person looks like: size, skin, hair and clothes, chosen by seed.
namespace posefusion::synth {

enum class Layer : std::uint8_t { Head, Arms, Shirt, Trousers, Shoes, Hair };
enum class Hair : std::uint8_t { Short, Long, Bun };
enum class Pattern : std::uint8_t { Plain, Stripes, Checks, Print };

/// sRGB 0..255 to linear 0..1.
[[nodiscard]] Vector3f linear_rgb(float r, float g, float b);

struct BodyLook {
    BodyLook() = default;
    BodyLook(std::uint64_t seed, bool woman);

    std::uint64_t seed = 0;
    bool woman = false;
    float height = 1.75f;  ///< metres
    float girth = 1;       ///< 1 = slim average
    bool long_sleeves = false;
    bool beard = false;
    Hair hair = Hair::Short;
    Pattern pattern = Pattern::Plain;
    Vector3f skin, hair_color, shirt, shirt_accent, trousers, shoes, iris;  ///< linear RGB albedo
};

/// Albedo at a point of a layer. @param rest  bind-pose position, body frame, metres
[[nodiscard]] Vector3f body_albedo(const BodyLook& look, float head_joint_height, Layer layer, const Vector3f& rest);

}  // namespace posefusion::synth
