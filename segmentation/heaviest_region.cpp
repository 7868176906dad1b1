#include "segmentation/heaviest_region.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "segmentation/convex_patches.hpp"

namespace posefusion {

std::vector<std::uint8_t> find_heaviest_region(const NodeGrid& grid, const std::function<bool(std::size_t)>& counts) {
    using C = HeaviestRegionConfig;
    const ConvexPatches patches = find_convex_patches(grid);
    std::vector<double> weight(grid.nodes.size(), 0), of_patch(static_cast<std::size_t>(patches.count), 0);
    double all = 0;
    std::size_t nodes = 0;
    for (std::size_t i = 0; i < grid.nodes.size(); ++i) {
        if (grid.nodes[i].depth <= 0 || !counts(i)) continue;
        const auto sigma = static_cast<double>(grid.noise.sigma(grid.nodes[i].depth) + grid.noise.floor);
        weight[i] = 1 / (sigma * sigma);
        all += weight[i];
        ++nodes;
        if (patches.patch[i] >= 0) of_patch[static_cast<std::size_t>(patches.patch[i])] += weight[i];
    }
    if (of_patch.empty()) return {};
    const auto heaviest = static_cast<int>(std::max_element(of_patch.begin(), of_patch.end()) - of_patch.begin());

    std::vector<std::uint8_t> region(grid.nodes.size(), 0);
    std::vector<std::size_t> members;
    double of_region = 0;
    const auto add = [&](std::size_t i) {
        region[i] = 1;
        members.push_back(i);
        of_region += weight[i];
    };
    for (std::size_t i = 0; i < grid.nodes.size(); ++i)
        if (patches.patch[i] == heaviest && weight[i] > 0) add(i);
    if (members.empty()) return {};
    const auto depth = [&](std::size_t i) { return grid.nodes[i].depth; };
    const auto [near, far] = std::minmax_element(members.begin(), members.end(),
                                                 [&](std::size_t a, std::size_t b) { return depth(a) < depth(b); });
    const float nearest = depth(*near) - C::kReach, farthest = depth(*far) + C::kReach;
    for (std::size_t k = 0; k < members.size(); ++k) {
        const auto n = static_cast<int>(members[k]);
        const float z = depth(members[k]);
        for (const auto& [dx, dy] : {std::pair(-1, 0), std::pair(1, 0), std::pair(0, -1), std::pair(0, 1)}) {
            const int x = n % grid.width + dx, y = n / grid.width + dy;
            if (!grid.contains(x, y)) continue;
            const std::size_t j = grid.index(x, y);
            const bool connected = std::abs(depth(j) - z) < C::kConnected * std::max(1.0f, z);
            if (region[j] == 0 && weight[j] > 0 && connected && depth(j) > nearest && depth(j) < farthest) add(j);
        }
    }
    const float share = static_cast<float>(members.size()) / static_cast<float>(nodes);
    if (of_region < C::kWeight * all || share < C::kLeast || share > C::kMost) return {};
    return region;
}

}  // namespace posefusion
