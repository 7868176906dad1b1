#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "hosts/synth/body_look.hpp"
#include "hosts/synth/skeleton.hpp"

/// A person's body: smooth surfaces around a skeleton, one per layer (head, arms, shirt, trousers, shoes, hair),
/// modelled in the bind pose and bent by linear blend skinning.
namespace posefusion::synth {

struct BodyVertex {
    Vector3f rest, rest_normal;           ///< bind pose
    float openness = 1;                   ///< share of ambient light that reaches it, 0..1
    std::array<std::uint8_t, 4> bones{};  ///< Bone
    std::array<float, 4> weights{};       ///< sum to 1
};

struct Body {
    BodyLook look;
    Proportions proportions;
    BoneTransforms bind{};
    std::vector<BodyVertex> vertices;
    std::vector<Triangle> triangles;
    std::vector<Layer> layers;  ///< per triangle
};

[[nodiscard]] Body make_body(const BodyLook& look);

struct PosedBody {
    std::vector<Vector3f> positions, normals;  ///< world
};

[[nodiscard]] PosedBody pose_body(const Body& body, const BoneTransforms& bones);

}  // namespace posefusion::synth
