#pragma once
#include <cmath>
#include <numbers>
#include <vector>

#include "engine/slam/slam.hpp"

namespace posefusion::test {

inline constexpr Rgb8 kUpperColor{200, 40, 30}, kLowerColor{20, 60, 220};

inline Surfel surfel_at(const Eigen::Vector3f& position, const Eigen::Vector3f& normal, Rgb8 color) {
    Surfel s{};
    s.position = position;
    s.normal = normal;
    s.color = color;
    s.radius = 0.005f;
    s.confidence = 20;
    return s;
}

/// Evenly covered, normals outwards, red above (z > 0), blue below.
inline std::vector<Surfel> sphere(const Eigen::Vector3f& centre, float radius, int count) {
    std::vector<Surfel> surfels;
    const float golden = std::numbers::pi_v<float> * (3 - std::sqrt(5.0f));
    for (int i = 0; i < count; ++i) {
        const float z = 1 - 2 * (static_cast<float>(i) + 0.5f) / static_cast<float>(count), r = std::sqrt(1 - z * z);
        const float angle = golden * static_cast<float>(i);
        const Eigen::Vector3f n(r * std::cos(angle), r * std::sin(angle), z);
        surfels.push_back(surfel_at(centre + radius * n, n, z > 0 ? kUpperColor : kLowerColor));
    }
    return surfels;
}

/// Side x side metres at z = 2, seen from the origin, one surfel per centimetre.
inline std::vector<Surfel> wall(float side) {
    std::vector<Surfel> surfels;
    const int half = static_cast<int>(side * 50);
    for (int v = -half; v <= half; ++v)
        for (int u = -half; u <= half; ++u)
            surfels.push_back(
                surfel_at({0.01f * static_cast<float>(u), 0.01f * static_cast<float>(v), 2}, {0, 0, -1}, kUpperColor));
    return surfels;
}

}  // namespace posefusion::test
