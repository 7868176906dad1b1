#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace posefusion {

/// The deformation graph that a loop bent the map with, for people to look at. World frame after that loop, metres.
struct LoopGraph {
    struct Node {
        Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< where the loop has put it
        Eigen::Vector3d moved = Eigen::Vector3d::Zero();     ///< from where it was before
    };
    std::uint32_t frame = 0;                          ///< of the loop
    std::vector<Node> nodes;                          ///< those of the map, then those of cameras
    std::uint32_t map_nodes = 0;                      ///< how many are of the map
    std::vector<std::array<std::uint32_t, 2>> edges;  ///< between which nodes
};

}  // namespace posefusion
