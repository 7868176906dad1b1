#include "hosts/synth/floor_plan.hpp"

#include <algorithm>
#include <limits>
#include <queue>

namespace posefusion::synth {
namespace {

constexpr float kCell = 0.05f;    ///< metres
constexpr int kSmoothing = 100;   ///< passes that round the corners
constexpr float kTallest = 2.0f;  ///< obstacles that hang higher do not matter

std::vector<Vector2f> resample(const std::vector<Vector2f>& line, float spacing) {
    std::vector<Vector2f> out{line.front()};
    float carried = 0;
    for (std::size_t i = 1; i < line.size(); ++i) {
        const float length = (line[i] - line[i - 1]).norm();
        float at = spacing - carried;
        for (; at <= length; at += spacing) out.push_back(line[i - 1] + (line[i] - line[i - 1]) * (at / length));
        carried = length - (at - spacing);
    }
    out.push_back(line.back());
    return out;
}

}  // namespace

FloorPlan::FloorPlan(const Room& room)
    : room_(room),
      columns_(static_cast<int>(std::ceil(room.size.x() / kCell))),
      rows_(static_cast<int>(std::ceil(room.size.y() / kCell))) {
    clearance_.resize(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    for (int i = 0; i < columns_ * rows_; ++i) clearance_[static_cast<std::size_t>(i)] = clearance(middle(i));
}

float FloorPlan::clearance(const Vector2f& p) const {
    float nearest = std::min({p.x(), p.y(), room_.size.x() - p.x(), room_.size.y() - p.y()});
    for (const Obstacle& o : room_.obstacles)
        if (o.bottom < kTallest) nearest = std::min(nearest, o.distance(p));
    for (const Obstacle& camera : room_.camera_space) nearest = std::min(nearest, camera.distance(p));
    return std::max(nearest, 0.0f);
}

int FloorPlan::cell(const Vector2f& p) const {
    const int c = std::clamp(static_cast<int>(p.x() / kCell), 0, columns_ - 1);
    const int r = std::clamp(static_cast<int>(p.y() / kCell), 0, rows_ - 1);
    return r * columns_ + c;
}

Vector2f FloorPlan::middle(int cell) const {
    const int column = cell % columns_, row = cell / columns_;
    return kCell * Vector2f(static_cast<float>(column) + 0.5f, static_cast<float>(row) + 0.5f);
}

/// Dijkstra over the cells; being near things costs, so that ways lead through the middle of free space. The two ends
/// may lie closer to things (in front of a chair) than the way between.
std::vector<Vector2f> FloorPlan::shortest(int from, int to) const {
    constexpr float kComfort = 0.45f, kEndZone = 0.27f, kEndClearance = 0.12f;
    std::vector<float> cost(clearance_.size(), std::numeric_limits<float>::max());
    std::vector<int> parent(clearance_.size(), -1);
    using Entry = std::pair<float, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
    cost[static_cast<std::size_t>(to)] = 0;
    open.emplace(0.0f, to);
    while (!open.empty()) {
        const auto [so_far, here] = open.top();
        open.pop();
        if (here == from) break;
        if (so_far > cost[static_cast<std::size_t>(here)]) continue;
        for (int dr = -1; dr <= 1; ++dr)
            for (int dc = -1; dc <= 1; ++dc) {
                const int c = here % columns_ + dc, r = here / columns_ + dr;
                if ((dr == 0 && dc == 0) || c < 0 || r < 0 || c >= columns_ || r >= rows_) continue;
                const int next = r * columns_ + c;
                const float room = clearance_[static_cast<std::size_t>(next)];
                const float to_end = std::min((middle(next) - middle(from)).norm(), (middle(next) - middle(to)).norm());
                if (room < (to_end < kEndZone ? kEndClearance : kWalkerRadius)) continue;
                const float squeeze = std::max(kComfort - room, 0.0f) / kComfort;
                const float total =
                    so_far + kCell * std::hypot(static_cast<float>(dr), static_cast<float>(dc)) * (1 + 6 * squeeze);
                if (total >= cost[static_cast<std::size_t>(next)]) continue;
                cost[static_cast<std::size_t>(next)] = total;
                parent[static_cast<std::size_t>(next)] = here;
                open.emplace(total, next);
            }
    }
    std::vector<Vector2f> way;
    if (parent[static_cast<std::size_t>(from)] < 0) return way;
    for (int c = from; c >= 0; c = parent[static_cast<std::size_t>(c)]) way.push_back(middle(c));
    return way;
}

std::vector<Vector2f> FloorPlan::route(const Vector2f& from, const Vector2f& to) const {
    std::vector<Vector2f> way = shortest(cell(from), cell(to));
    if (way.size() < 2) return {};
    way.front() = from;
    way.back() = to;
    way = resample(way, 2 * kRouteSpacing);
    // Round the corners, but never into anything: a point moves only where it keeps the walker's radius.
    for (int pass = 0; pass < kSmoothing; ++pass)
        for (std::size_t i = 1; i + 1 < way.size(); ++i) {
            const Vector2f smooth = 0.5f * (way[i - 1] + way[i + 1]);
            if (clearance(smooth) >= std::min(kWalkerRadius, clearance(way[i]))) way[i] = smooth;
        }
    return resample(way, kRouteSpacing);
}

}  // namespace posefusion::synth
