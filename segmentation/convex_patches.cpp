#include "segmentation/convex_patches.hpp"

#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

namespace posefusion {
namespace {

/// Normals of neighbours turn by more than this, radians, at a crease: ten degrees. The crease of two walls is spread
/// by the normals' window over four nodes, 22 degrees each.
constexpr float kCrease = 0.17f;
/// Metres of depth step that slant does not explain, beyond noise.
constexpr float kStep = 0.02f;

enum class Seam { None, Smooth, Convex };

Seam seam_of(const Node& a, const Node& b, const DepthNoise& noise) {
    if (a.depth <= 0 || b.depth <= 0 || a.normal.isZero() || b.normal.isZero()) return Seam::None;
    const Eigen::Vector3f between = b.point - a.point;
    const float step = std::max(std::abs(a.normal.dot(between)), std::abs(b.normal.dot(between)));
    const float extent = between.norm();
    if (step > kStep + noise.sigma(std::max(a.depth, b.depth)) + 0.5f * extent) return Seam::None;
    const float cosine = a.normal.dot(b.normal);
    if (cosine > std::cos(kCrease)) return Seam::Smooth;
    return (b.normal - a.normal).dot(between) > 0 && cosine > 0.5f ? Seam::Convex : Seam::None;  // normals diverge
}

/// Connected nodes, as a forest.
class Regions {
public:
    explicit Regions(std::size_t nodes) : parent_(nodes) { std::iota(parent_.begin(), parent_.end(), 0); }
    void connect(std::size_t i, std::size_t j) {
        const int a = root(static_cast<int>(i)), b = root(static_cast<int>(j));
        parent_[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
    }
    /// Numbers the regions in the order of their first nodes. @return how many there are
    int number(const NodeGrid& grid, std::vector<int>& region) {
        int count = 0;
        region.assign(grid.nodes.size(), -1);
        for (std::size_t i = 0; i < grid.nodes.size(); ++i) {
            if (grid.nodes[i].normal.isZero()) continue;
            const auto r = static_cast<std::size_t>(root(static_cast<int>(i)));  // the first node of its region
            region[i] = r == i ? count++ : region[r];
        }
        return count;
    }

private:
    int root(int i) {
        while (parent_[static_cast<std::size_t>(i)] != i) {
            int& up = parent_[static_cast<std::size_t>(i)];
            up = parent_[static_cast<std::size_t>(up)];
            i = up;
        }
        return i;
    }
    std::vector<int> parent_;
};

/// Nodes at the rim of a surface have no normal of their own: they belong to the region whose plane goes on there.
void take_rims(const NodeGrid& grid, ConvexPatches& patches) {
    std::vector<int> surface(grid.nodes.size(), -1);  // per node, the one with a normal that it belongs to
    for (std::size_t i = 0; i < surface.size(); ++i)
        if (patches.patch[i] >= 0) surface[i] = static_cast<int>(i);
    for (int ring = 0; ring < kNormalReach; ++ring) {
        const std::vector<int> inner = surface;
        const auto join = [&](int x, int y) {
            const std::size_t i = grid.index(x, y);
            const Node& node = grid.nodes[i];
            if (node.depth <= 0 || inner[i] >= 0) return;
            float nearest = kStep + grid.noise.sigma(node.depth);
            for (const auto& [dx, dy] : {std::pair(-1, 0), std::pair(1, 0), std::pair(0, -1), std::pair(0, 1)}) {
                if (!grid.contains(x + dx, y + dy)) continue;
                const int other = inner[grid.index(x + dx, y + dy)];
                if (other < 0) continue;
                const Node& owner = grid.nodes[static_cast<std::size_t>(other)];
                const float distance = std::abs(owner.normal.dot(node.point - owner.point));
                if (distance >= nearest) continue;
                nearest = distance;
                surface[i] = other;
            }
        };
        for (int y = 0; y < grid.height; ++y)
            for (int x = 0; x < grid.width; ++x) join(x, y);
    }
    for (std::size_t i = 0; i < surface.size(); ++i) {
        if (surface[i] < 0) continue;
        patches.patch[i] = patches.patch[static_cast<std::size_t>(surface[i])];
        patches.face[i] = patches.face[static_cast<std::size_t>(surface[i])];
    }
}

}  // namespace

ConvexPatches find_convex_patches(const NodeGrid& grid) {
    Regions convex(grid.nodes.size()), smooth(grid.nodes.size());
    const auto connect = [&](std::size_t i, std::size_t j) {
        const Seam seam = seam_of(grid.nodes[i], grid.nodes[j], grid.noise);
        if (seam != Seam::None) convex.connect(i, j);
        if (seam == Seam::Smooth) smooth.connect(i, j);
    };
    for (int y = 0; y < grid.height; ++y)
        for (int x = 0; x < grid.width; ++x) {
            if (x + 1 < grid.width) connect(grid.index(x, y), grid.index(x + 1, y));
            if (y + 1 < grid.height) connect(grid.index(x, y), grid.index(x, y + 1));
        }
    ConvexPatches patches;
    patches.count = convex.number(grid, patches.patch);
    patches.face_count = smooth.number(grid, patches.face);
    take_rims(grid, patches);
    return patches;
}

}  // namespace posefusion
