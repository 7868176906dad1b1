#pragma once
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "segmentation/node_grid.hpp"

namespace posefusion {

struct HeaviestRegionConfig {
    static constexpr double kWeight = 0.3;                ///< of what the depth of all nodes says, at least
    static constexpr float kLeast = 0.1f, kMost = 0.65f;  ///< of the nodes
    static constexpr float kConnected = 0.05f;            ///< depth step of neighbours, metres; of the depth beyond 1 m
    static constexpr float kReach = 0.3f;                 ///< in front of and behind its largest patch, metres
};

/// The thing that the depth of a frame says most about: near surfaces are measured so much better than far ones that
/// one in a quarter of the image outweighs the room behind it. A patch, and what is connected with it at its distance.
/// @param counts  whether a node (by index) does; others are no part of it
/// @return per node, 1: of the thing; empty: nothing outweighs the rest like that, or it is nearly all there is
[[nodiscard]] std::vector<std::uint8_t> find_heaviest_region(const NodeGrid& grid,
                                                             const std::function<bool(std::size_t)>& counts);

}  // namespace posefusion
