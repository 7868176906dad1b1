#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

namespace posefusion {

/// The deformation graph of a closed loop, for visualisation. World frame after that loop, metres.
struct LoopGraph {
    struct Node {
        Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< after the loop
        Eigen::Vector3d moved = Eigen::Vector3d::Zero();     ///< displacement by the loop
    };
    std::uint32_t frame = 0;                          ///< of the loop
    std::vector<Node> nodes;                          ///< map nodes, then camera nodes
    std::uint32_t map_nodes = 0;                      ///< number of map nodes
    std::vector<std::array<std::uint32_t, 2>> edges;  ///< pairs of node indices
};

}  // namespace posefusion
