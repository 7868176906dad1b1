#include "segmentation/mask_memory.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "engine/core/pinhole.hpp"

namespace posefusion {
namespace {

/// Calls visit(node index) for the up to four nodes a point covers, so that moving closer leaves no gaps.
template <class Visit>
void splat(const NodeGrid& grid, const Eigen::Vector3f& point, Visit visit) {
    constexpr float kNearest = 0.1f;  // points nearer than this are behind or inside the camera, metres
    if (!(point.z() >= kNearest)) return;
    const Eigen::Vector2f at = project(point, grid.camera);
    const float x = at.x(), y = at.y();
    if (!(x > -2 && y > -2 && x < static_cast<float>(grid.width + 1) && y < static_cast<float>(grid.height + 1)))
        return;
    const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
    for (int dy = 0; dy <= 1; ++dy)
        for (int dx = 0; dx <= 1; ++dx)
            if (grid.contains(x0 + dx, y0 + dy)) visit(grid.index(x0 + dx, y0 + dy));
}

}  // namespace

std::vector<Memory> MaskMemory::recall(const NodeGrid& grid, const Eigen::Isometry3f& T_current_previous,
                                       const std::function<Eigen::Vector3f(int)>& displacement) {
    std::vector<Memory> memory(grid.nodes.size());
    recalled_.assign(grid.nodes.size(), {Eigen::Vector3f::Zero(), Eigen::Vector3f::Zero(), 0});
    for (const StaticPoint& kept : static_points_) {
        const Eigen::Vector3f point = T_current_previous * kept.point;
        splat(grid, point, [&](std::size_t i) {
            if (memory[i].static_depth > 0 && memory[i].static_depth <= point.z()) return;
            memory[i].static_depth = point.z();
            recalled_[i] = {point, kept.color, kept.age};
        });
    }
    for (const PersonPoint& kept : person_points_) {
        const Eigen::Vector3f point = T_current_previous * Eigen::Vector3f(kept.point + displacement(kept.person));
        splat(grid, point, [&](std::size_t i) {
            if (memory[i].person > 0 && memory[i].person_depth <= point.z()) return;
            memory[i].person = kept.person;
            memory[i].person_depth = point.z();
        });
    }
    for (int y = 0; y < grid.height; ++y)
        for (int x = 0; x < grid.width; ++x) compare_around(grid, x, y, memory);
    return memory;
}

void MaskMemory::save(StateWriter& out) const {
    out.list(static_points_, [&](const StaticPoint& kept) {
        out.put(kept.point);
        out.put(kept.color);
        out.put(kept.age);
    });
    out.list(person_points_, [&](const PersonPoint& kept) {
        out.put(kept.point);
        out.put(kept.person);
    });
}

void MaskMemory::load(StateReader& in) {
    static_points_ = in.list<StaticPoint>(sizeof(StaticPoint), [&] {
        StaticPoint kept;
        kept.point = in.get_matrix<Eigen::Vector3f>();
        kept.color = in.get_matrix<Eigen::Vector3f>();
        kept.age = in.get<float>();
        return kept;
    });
    person_points_ = in.list<PersonPoint>(sizeof(PersonPoint), [&] {
        PersonPoint kept;
        kept.point = in.get_matrix<Eigen::Vector3f>();
        kept.person = in.get<int>();
        return kept;
    });
}

void MaskMemory::compare_around(const NodeGrid& grid, int x, int y, std::vector<Memory>& memory) const {
    const std::size_t i = grid.index(x, y);
    Memory& node = memory[i];
    node.nearest_static = node.static_depth;
    float change = 1;
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            if (!grid.contains(x + dx, y + dy)) continue;
            const std::size_t j = grid.index(x + dx, y + dy);
            node.nearest_static = std::min(node.nearest_static, memory[j].static_depth);
            if (grid.nodes[i].depth <= 0 && memory[j].static_depth > 0)
                change = std::min(change, (recalled_[j].color - grid.nodes[i].color).norm());
        }
    node.color_change = change;
}

void MaskMemory::remember(const NodeGrid& grid, const std::vector<int>& person) {
    static_points_.clear();
    person_points_.clear();
    for (std::size_t i = 0; i < grid.nodes.size(); ++i) {
        const Node& node = grid.nodes[i];
        if (node.depth > 0 && person[i] > 0) person_points_.push_back({node.point, person[i]});
        // Whatever hides a remembered surface has moved there: a person, perhaps one not detected yet.
        StaticPoint hidden = recalled_[i];
        hidden.age += 1.0f / static_cast<float>(person[i] > 0 ? config_.behind_people : config_.behind_static);
        if (hidden.age <= 1 && hidden.point.z() > node.depth + config_.step_in_front + 2 * grid.noise.sigma(node.depth))
            static_points_.push_back(hidden);
        else if (node.depth > 0 && person[i] == 0)
            static_points_.push_back({node.point, node.color, 0});
    }
}

}  // namespace posefusion
