#include "tools/evaluate_mesh/surface_index.hpp"

#include <algorithm>
#include <cmath>

#include "tools/evaluate_objects/triangle_distance.hpp"

namespace posefusion {

SurfaceIndex::SurfaceIndex(const TrueMesh& mesh, float limit) : limit_(limit) {
    for (const auto& [i, j, k] : mesh.faces) add({mesh.vertices[i], mesh.vertices[j], mesh.vertices[k]});
}

std::size_t SurfaceIndex::Hash::operator()(const Cell& cell) const {
    std::size_t hash = 0;
    for (const int axis : cell) hash = hash * 1'000'003 + static_cast<std::size_t>(axis);
    return hash;
}

SurfaceIndex::Cell SurfaceIndex::cell_of(const Eigen::Vector3f& point) const {
    Cell cell{};
    for (int axis = 0; axis < 3; ++axis)
        cell[static_cast<std::size_t>(axis)] = static_cast<int>(std::floor(point[axis] / limit_));
    return cell;
}

/// Large triangles are halved until they are of the size of a cell: the box around a wall holds all the room.
void SurfaceIndex::add(const Corners& c) {
    const std::array<float, 3> edges{(c[1] - c[0]).norm(), (c[2] - c[1]).norm(), (c[0] - c[2]).norm()};
    const auto longest = static_cast<std::size_t>(std::max_element(edges.begin(), edges.end()) - edges.begin());
    if (edges[longest] > 2 * limit_) {
        const Eigen::Vector3f &a = c[longest], &b = c[(longest + 1) % 3], &d = c[(longest + 2) % 3];
        const Eigen::Vector3f middle = (a + b) / 2;
        add({a, middle, d});
        add({middle, b, d});
        return;
    }
    const auto number = static_cast<std::uint32_t>(triangles_.size());
    triangles_.push_back(c);
    const Cell low = cell_of(c[0].cwiseMin(c[1]).cwiseMin(c[2])), high = cell_of(c[0].cwiseMax(c[1]).cwiseMax(c[2]));
    for (int x = low[0]; x <= high[0]; ++x)
        for (int y = low[1]; y <= high[1]; ++y)
            for (int z = low[2]; z <= high[2]; ++z) cells_[{x, y, z}].push_back(number);
}

std::optional<float> SurfaceIndex::distance(const Eigen::Vector3f& point) const {
    const Cell home = cell_of(point);
    float nearest = limit_;
    bool found = false;
    for (int x = home[0] - 1; x <= home[0] + 1; ++x)
        for (int y = home[1] - 1; y <= home[1] + 1; ++y)
            for (int z = home[2] - 1; z <= home[2] + 1; ++z) {
                const auto cell = cells_.find({x, y, z});
                if (cell == cells_.end()) continue;
                for (const std::uint32_t number : cell->second) {
                    const Corners& c = triangles_[number];
                    const float away = (closest_on_triangle(point, c[0], c[1], c[2]) - point).norm();
                    if (away > nearest) continue;
                    nearest = away;
                    found = true;
                }
            }
    return found ? std::optional(nearest) : std::nullopt;
}

}  // namespace posefusion
