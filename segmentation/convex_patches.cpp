#include "segmentation/convex_patches.hpp"

#include <cmath>
#include <cstddef>
#include <numeric>

namespace posefusion {
namespace {

/// Normals of neighbours turn by more than this, radians, at a crease: ten degrees. The crease of two walls is spread
/// by the normals' window over four nodes, 22 degrees each.
constexpr float kCrease = 0.17f;
/// Metres of depth step that slant does not explain, beyond noise.
constexpr float kStep = 0.02f;

bool are_connected(const Node& a, const Node& b, const DepthNoise& noise) {
    if (a.depth <= 0 || b.depth <= 0 || a.normal.isZero() || b.normal.isZero()) return false;
    const Eigen::Vector3f between = b.point - a.point;
    const float step = std::max(std::abs(a.normal.dot(between)), std::abs(b.normal.dot(between)));
    const float extent = between.norm();
    if (step > kStep + noise.sigma(std::max(a.depth, b.depth)) + 0.5f * extent) return false;
    const float cosine = a.normal.dot(b.normal);
    if (cosine > std::cos(kCrease)) return true;
    return (b.normal - a.normal).dot(between) > 0 && cosine > 0.5f;  // convex: normals diverge
}

}  // namespace

ConvexPatches find_convex_patches(const NodeGrid& grid) {
    std::vector<int> parent(grid.nodes.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](int i) {
        while (parent[static_cast<std::size_t>(i)] != i) {
            int& up = parent[static_cast<std::size_t>(i)];
            up = parent[static_cast<std::size_t>(up)];
            i = up;
        }
        return i;
    };
    const auto connect = [&](std::size_t i, std::size_t j) {
        if (!are_connected(grid.nodes[i], grid.nodes[j], grid.noise)) return;
        const int a = root(static_cast<int>(i)), b = root(static_cast<int>(j));
        parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    };
    for (int y = 0; y < grid.height; ++y)
        for (int x = 0; x < grid.width; ++x) {
            if (x + 1 < grid.width) connect(grid.index(x, y), grid.index(x + 1, y));
            if (y + 1 < grid.height) connect(grid.index(x, y), grid.index(x, y + 1));
        }
    ConvexPatches patches;
    patches.patch.assign(grid.nodes.size(), -1);
    for (std::size_t i = 0; i < grid.nodes.size(); ++i) {
        if (grid.nodes[i].normal.isZero()) continue;
        const auto r = static_cast<std::size_t>(root(static_cast<int>(i)));  // the first node of its patch
        if (r == i)
            patches.patch[i] = patches.count++;
        else
            patches.patch[i] = patches.patch[r];
    }
    return patches;
}

}  // namespace posefusion
