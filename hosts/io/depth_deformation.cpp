#include "hosts/io/depth_deformation.hpp"

#include <algorithm>

namespace posefusion {

DeformationCell deformation_cell(double u, double v, int width, int height) {
    const auto along = [](double position, int size, int nodes) {
        const double at = position / std::max(1, size - 1) * (nodes - 1);
        const int first = std::clamp(static_cast<int>(at), 0, nodes - 2);
        return std::pair(first, std::clamp(at - first, 0.0, 1.0));
    };
    const auto [column, x] = along(u, width, DepthDeformation::kColumns);
    const auto [row, y] = along(v, height, DepthDeformation::kRows);
    constexpr std::size_t kNextRow = DepthDeformation::kColumns;
    const std::size_t node = static_cast<std::size_t>(row) * kNextRow + static_cast<std::size_t>(column);
    return {{node, node + 1, node + kNextRow, node + kNextRow + 1},
            {(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y}};
}

Image<float> deformation_map(const DepthDeformation& deformation, int width, int height) {
    if (deformation.is_none()) return {};
    Image<float> map(width, height);
    for (int v = 0; v < height; ++v) {
        for (int u = 0; u < width; ++u) {
            const DeformationCell cell = deformation_cell(u, v, width, height);
            double c = 0;
            for (std::size_t i = 0; i < cell.nodes.size(); ++i)
                c += cell.weights[i] * static_cast<double>(deformation.nodes[cell.nodes[i]]);
            map(u, v) = static_cast<float>(c);
        }
    }
    return map;
}

void undo_deformation(const Image<float>& map, DepthImage& depth) {
    for (std::size_t i = 0; i < map.size(); ++i) {
        const float z = depth[i], share = 1 + map[i] * z;
        depth[i] = share > 0 ? z / share : 0;
    }
}

}  // namespace posefusion
