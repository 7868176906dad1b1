#include "segmentation/node_grid.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "engine/core/median.hpp"
#include "engine/core/pinhole.hpp"

namespace posefusion {
namespace {

Node make_node(const ColorImage& color, const DepthImage& depth, int u0, int v0, int u1, int v1,
               std::vector<float>& scratch) {
    Node node;
    scratch.clear();
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (int v = v0; v < v1; ++v)
        for (int u = u0; u < u1; ++u) {
            const float z = depth(u, v);
            if (z > 0 && std::isfinite(z)) scratch.push_back(z);
            const Rgb8& c = color(u, v);
            sum += Eigen::Vector3f(c.r, c.g, c.b);
        }
    const int pixels = (u1 - u0) * (v1 - v0);
    node.color = sum / (255.0f * static_cast<float>(pixels));
    if (4 * static_cast<int>(scratch.size()) >= pixels && !scratch.empty()) node.depth = upper_median(scratch);
    return node;
}

/// Normals from central differences over two nodes each way, where no depth jump lies between.
void compute_normals(NodeGrid& grid) {
    constexpr float kJump = 0.05f;  // metres per node of reach at one metre
    for (int y = kNormalReach; y + kNormalReach < grid.height; ++y)
        for (int x = kNormalReach; x + kNormalReach < grid.width; ++x) {
            Node& node = grid.nodes[grid.index(x, y)];
            if (node.depth <= 0) continue;
            const Node &left = grid.at(x - kNormalReach, y), &right = grid.at(x + kNormalReach, y);
            const Node &up = grid.at(x, y - kNormalReach), &down = grid.at(x, y + kNormalReach);
            const float limit = kJump * kNormalReach * std::max(1.0f, node.depth);
            bool smooth = true;
            for (const Node* n : {&left, &right, &up, &down})
                smooth = smooth && n->depth > 0 && std::abs(n->depth - node.depth) < limit;
            if (!smooth) continue;
            Eigen::Vector3f normal = (down.point - up.point).cross(right.point - left.point);
            const float length = normal.norm();
            if (length <= 0) continue;
            normal /= length;
            node.normal = normal.dot(node.point) > 0 ? Eigen::Vector3f(-normal) : normal;
        }
}

/// Depth of the background of holes.
void fill_behind(NodeGrid& grid) {
    for (int y = 0; y < grid.height; ++y) {
        float left = 0;
        for (int x = 0; x < grid.width; ++x) {
            Node& node = grid.nodes[grid.index(x, y)];
            if (node.depth > 0)
                left = node.depth;
            else
                node.behind = left;
        }
        float right = 0;
        for (int x = grid.width - 1; x >= 0; --x) {
            Node& node = grid.nodes[grid.index(x, y)];
            if (node.depth > 0)
                right = node.depth;
            else
                node.behind = node.behind > 0 && right > 0 ? std::max(node.behind, right) : 0;
        }
    }
}

}  // namespace

int node_step(const Intrinsics& camera) {
    constexpr float kNodesAcross = 160;
    return std::max(1, static_cast<int>(std::lround(static_cast<float>(camera.width) / kNodesAcross)));
}

NodeGrid make_node_grid(const ColorImage& color, const DepthImage& depth, const Intrinsics& camera,
                        const DepthNoise& noise, int step) {
    NodeGrid grid;
    grid.step = step;
    grid.noise = noise;
    grid.width = (depth.width() + step - 1) / step;
    grid.height = (depth.height() + step - 1) / step;
    const float scale = 1.0f / static_cast<float>(step);
    grid.camera = camera.scaled(scale);
    grid.camera.width = grid.width;
    grid.camera.height = grid.height;
    grid.nodes.reserve(static_cast<std::size_t>(grid.width) * static_cast<std::size_t>(grid.height));
    std::vector<float> scratch;
    scratch.reserve(static_cast<std::size_t>(step) * static_cast<std::size_t>(step));
    for (int y = 0; y < grid.height; ++y)
        for (int x = 0; x < grid.width; ++x) {
            Node node = make_node(color, depth, x * step, y * step, std::min((x + 1) * step, depth.width()),
                                  std::min((y + 1) * step, depth.height()), scratch);
            if (node.depth > 0)
                node.point = back_project(static_cast<float>(x), static_cast<float>(y), node.depth, grid.camera);
            grid.nodes.push_back(node);
        }
    compute_normals(grid);
    fill_behind(grid);
    return grid;
}

}  // namespace posefusion
