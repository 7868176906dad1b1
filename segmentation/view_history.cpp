#include "segmentation/view_history.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/pinhole.hpp"

namespace posefusion {
namespace {

constexpr float kNearest = 0.1f;  // metres: no depth camera measures nearer

/// The least value (or the greatest, by `better`) of the nodes within `radius` of each, in a square; 0 where one of
/// them is unknown or outside.
template <class Better>
std::vector<float> extreme_around(const std::vector<float>& values, int width, int height, int radius, Better better) {
    const auto at = [&](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
    };
    const auto join = [&](float a, float b) { return a > 0 && b > 0 ? better(a, b) : 0.0f; };
    std::vector<float> rows(values.size(), 0), result(values.size(), 0);
    for (int y = 0; y < height; ++y)
        for (int x = radius; x + radius < width; ++x) {
            float value = values[at(x, y)];
            for (int d = -radius; d <= radius; ++d) value = join(value, values[at(x + d, y)]);
            rows[at(x, y)] = value;
        }
    for (int y = radius; y + radius < height; ++y)
        for (int x = 0; x < width; ++x) {
            float value = rows[at(x, y)];
            for (int d = -radius; d <= radius; ++d) value = join(value, rows[at(x, y + d)]);
            result[at(x, y)] = value;
        }
    return result;
}

std::vector<float> least_around(const std::vector<float>& values, const NodeGrid& grid, int radius) {
    return extreme_around(values, grid.width, grid.height, radius, [](float a, float b) { return std::min(a, b); });
}

std::vector<float> greatest_around(const std::vector<float>& values, const NodeGrid& grid, int radius) {
    return extreme_around(values, grid.width, grid.height, radius, [](float a, float b) { return std::max(a, b); });
}

float angle_of(const Eigen::Isometry3f& T) { return Eigen::AngleAxisf(T.linear()).angle(); }

/// The node that a point is seen at, if it is at least a node away from the border.
struct SeenAt {
    bool inside = false;
    std::size_t node = 0;
    int x = 0, y = 0;
};
SeenAt seen_at(const NodeGrid& grid, const Eigen::Vector3f& p, int border) {
    if (!(p.z() > kNearest)) return {};
    const Eigen::Vector2f at = project(p, grid.camera);
    const auto least = static_cast<float>(border) - 0.5f;
    if (!(at.x() > least && at.y() > least && at.x() < static_cast<float>(grid.width) - least - 1 &&
          at.y() < static_cast<float>(grid.height) - least - 1))
        return {};
    const int x = static_cast<int>(std::lround(at.x())), y = static_cast<int>(std::lround(at.y()));
    return {true, grid.index(x, y), x, y};
}

}  // namespace

std::vector<Sightings> ViewHistory::look_back(const NodeGrid& grid, const std::vector<float>& nearest,
                                              const Eigen::Isometry3f& T_previous_current) const {
    std::vector<Sightings> sightings(grid.nodes.size());
    const std::vector<float> clear_now = least_around(nearest, grid, 1);
    const float blur_now = config_.shutter * angle_of(T_previous_current) * grid.camera.fx;
    for (const View& view : views_) {
        const Eigen::Isometry3f T_view_current = view.T_view_last * T_previous_current;
        const Eigen::Isometry3f T_current_view = T_view_current.inverse();
        const float angle = angle_of(T_view_current), way = T_view_current.translation().norm();
        const int blur = static_cast<int>(
            std::ceil(std::max(0.0f, view.blur + blur_now + config_.drift * angle * grid.camera.fx - 0.5f)));
        const int border = 1 + blur;
        for (std::size_t i = 0; i < grid.nodes.size(); ++i) {
            if (grid.nodes[i].depth <= 0) continue;
            const Eigen::Vector3f q = T_view_current * grid.nodes[i].point;
            const SeenAt at = seen_at(grid, q, border);
            if (!at.inside) continue;
            const float drift = config_.margin + config_.drift * (way + angle * q.z());
            const float gate = drift + config_.sigmas * grid.noise.sigma(std::max(view.depth[at.node], q.z()));
            float clear = view.clear[at.node], farthest = view.farthest[at.node];
            if (blur > 0) {
                for (int dy = -blur; dy <= blur; dy += blur)
                    for (int dx = -blur; dx <= blur; dx += blur) {
                        const std::size_t j = grid.index(at.x + dx, at.y + dy);
                        clear = std::min(clear, view.clear[j]);
                        farthest = view.farthest[j] > 0 && farthest > 0 ? std::max(farthest, view.farthest[j]) : 0;
                    }
            }
            if (clear - q.z() > gate) {
                ++sightings[i].free;
                continue;
            }
            if (farthest > 0 && q.z() - farthest > gate && q.z() - farthest < config_.receded) {
                const Eigen::Vector3f before =
                    T_current_view *
                    back_project(static_cast<float>(at.x), static_cast<float>(at.y), view.depth[at.node], grid.camera);
                const SeenAt now = seen_at(grid, before, 1);
                if (now.inside && clear_now[now.node] - before.z() > gate) {
                    ++sightings[i].left;
                    sightings[i].there_since = 0;
                }
                continue;
            }
            bool there = false;
            for (int dy = -1; dy <= 1; ++dy)
                for (int dx = -1; dx <= 1; ++dx)
                    there = there || std::abs(view.depth[grid.index(at.x + dx, at.y + dy)] - q.z()) < gate;
            if (!there) continue;
            ++sightings[i].there;
            ++sightings[i].there_since;
            if (sightings[i].left == 0) sightings[i].there_before = true;
        }
    }
    for (Sightings& seen : sightings)
        if (seen.left > 0 && (seen.there_before || seen.there_since >= config_.settled)) {
            seen.left = 0;
            seen.was_hidden = seen.free == 0;
        }
    return sightings;
}

void ViewHistory::add(const NodeGrid& grid, const std::vector<float>& nearest,
                      const Eigen::Isometry3f& T_previous_current) {
    for (View& view : views_) view.T_view_last = view.T_view_last * T_previous_current;
    if (!views_.empty() && ++since_kept_ < config_.every) return;
    since_kept_ = 0;
    View view{Eigen::Isometry3f::Identity(),
              config_.shutter * angle_of(T_previous_current) * grid.camera.fx,
              {},
              least_around(nearest, grid, 1),
              {}};
    view.depth.reserve(grid.nodes.size());
    for (const Node& node : grid.nodes) view.depth.push_back(node.depth);
    view.farthest = greatest_around(view.depth, grid, 1);
    if (static_cast<int>(views_.size()) == config_.views) views_.erase(views_.begin());
    views_.push_back(std::move(view));
}

void ViewHistory::clear() {
    views_.clear();
    since_kept_ = 0;
}

void ViewHistory::save(StateWriter& out) const {
    out.put(since_kept_);
    out.list(views_, [&](const View& view) {
        out.put(view.T_view_last.matrix());
        out.put(view.blur);
        out.list(view.depth, [&](float z) { out.put(z); });
        out.list(view.clear, [&](float z) { out.put(z); });
        out.list(view.farthest, [&](float z) { out.put(z); });
    });
}

void ViewHistory::load(StateReader& in, std::size_t nodes) {
    since_kept_ = in.get<int>();
    views_ = in.list<View>(sizeof(Eigen::Matrix4f), [&] {
        View view;
        view.T_view_last.matrix() = in.get_matrix<Eigen::Matrix4f>();
        view.blur = in.get<float>();
        view.depth = in.list<float>(sizeof(float), [&] { return in.get<float>(); });
        view.clear = in.list<float>(sizeof(float), [&] { return in.get<float>(); });
        view.farthest = in.list<float>(sizeof(float), [&] { return in.get<float>(); });
        if (view.depth.size() != nodes || view.clear.size() != nodes || view.farthest.size() != nodes) in.fail();
        return view;
    });
}

}  // namespace posefusion
