#pragma once
#include <Eigen/Core>
#include <vector>

#include "engine/core/depth_noise.hpp"
#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"

/// The organised image at the resolution of the graph: one node per block of pixels.
namespace posefusion {

/// Nodes on each side that a normal is computed from.
inline constexpr int kNormalReach = 2;

struct Node {
    float depth = 0;   ///< median of the block in metres; 0 = fewer than a quarter of the block has depth
    float behind = 0;  ///< for nodes without depth: the farther of the depths left and right, as shadows of near things
                       ///< fall on what is behind; 0 where a side has none, metres
    Eigen::Vector3f point = Eigen::Vector3f::Zero();   ///< camera coordinates, metres; zero without depth
    Eigen::Vector3f normal = Eigen::Vector3f::Zero();  ///< unit, towards the camera; zero where it cannot be told
    Eigen::Vector3f color = Eigen::Vector3f::Zero();   ///< mean of the block, 0..1
};

struct NodeGrid {
    int step = 4;  ///< pixels per node and direction
    int width = 0, height = 0;
    Intrinsics camera;  ///< intrinsics of the grid: nodes project to integer coordinates
    DepthNoise noise;   ///< of the depth camera
    std::vector<Node> nodes;

    [[nodiscard]] bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < width && y < height; }
    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    }
    [[nodiscard]] const Node& at(int x, int y) const { return nodes[index(x, y)]; }
};

/// Pixels per node of the graph that is cut: it has about 160 nodes across the image, whatever its size, so that a
/// forearm at three metres is four nodes wide.
[[nodiscard]] int node_step(const Intrinsics& camera);

/// Blocks of step x step pixels; those cut by the right and lower border are smaller.
[[nodiscard]] NodeGrid make_node_grid(const ColorImage& color, const DepthImage& depth, const Intrinsics& camera,
                                      const DepthNoise& noise, int step);

}  // namespace posefusion
