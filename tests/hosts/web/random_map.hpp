#pragma once
#include <random>
#include <vector>

#include "engine/map/surfel.hpp"

namespace posefusion::test {

/// Surfels all over a room, no two alike.
inline std::vector<Surfel> random_map(std::size_t count, float room = 6.0f) {
    std::mt19937 random(1);
    std::uniform_real_distribution<float> unit(0, 1);
    std::vector<Surfel> surfels(count);
    for (std::size_t i = 0; i < count; ++i) {
        Surfel& s = surfels[i];
        s.position = room * Eigen::Vector3f(unit(random) - 0.5f, unit(random) - 0.5f, unit(random));
        s.normal = Eigen::Vector3f(unit(random) - 0.5f, unit(random) - 0.5f, unit(random) - 0.5f).normalized();
        s.color = {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8), 7};
        s.radius = 0.001f + 0.02f * unit(random);
        s.confidence = 10 + 90 * unit(random);
        s.created = static_cast<std::uint32_t>(i % 300);
        s.last_seen = static_cast<std::uint32_t>(i % 7 == 0 ? 299 : 280 + i % 19);
    }
    return surfels;
}

}  // namespace posefusion::test
