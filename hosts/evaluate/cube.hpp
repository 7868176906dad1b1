#pragma once
#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

/// A grid of cubes, for look-ups by position.
namespace posefusion {

using Cube = std::array<std::int32_t, 3>;

struct CubeHash {
    std::size_t operator()(const Cube& cube) const {
        // Large odd multipliers, as in Teschner et al. 2003.
        return static_cast<std::size_t>(static_cast<std::uint32_t>(cube[0])) * 73856093u ^
               static_cast<std::size_t>(static_cast<std::uint32_t>(cube[1])) * 19349663u ^
               static_cast<std::size_t>(static_cast<std::uint32_t>(cube[2])) * 83492791u;
    }
};

/// @param side  of the cubes, metres
[[nodiscard]] inline Cube cube_of(const Eigen::Vector3d& point, float side) {
    const auto index = [&](double x) { return static_cast<std::int32_t>(std::floor(x / side)); };
    return {index(point.x()), index(point.y()), index(point.z())};
}

/// The cube itself and the 26 around it.
template <class Visit>
void for_each_near(const Cube& centre, const Visit& visit) {
    for (std::int32_t z = centre[2] - 1; z <= centre[2] + 1; ++z)
        for (std::int32_t y = centre[1] - 1; y <= centre[1] + 1; ++y)
            for (std::int32_t x = centre[0] - 1; x <= centre[0] + 1; ++x) visit(Cube{x, y, z});
}

}  // namespace posefusion
