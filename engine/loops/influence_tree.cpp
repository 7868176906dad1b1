#include "engine/loops/influence_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace posefusion {
namespace {

using std::size_t;

constexpr size_t kTime = 3, kAxes = 4;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A box with samples in it is halved until its list is short or it is small (in node spacings); one without only until
// the list is fit for the few that may get there. Longer lists are replaced by that of all nodes.
constexpr size_t kShortList = 24, kFitList = 128;
constexpr double kSmall = 0.8, kSmallEmpty = 2;
constexpr double kFarEmpty = 2;      // node spacings; no box without samples is halved when so far from all nodes
constexpr double kAround = 1.25;     // place sizes around a place that count as it ...
constexpr double kAroundTime = 0.5;  // ... and temporal windows before and after it
constexpr double kSlack = 1e-4;      // metres, tolerance for single precision on the device
constexpr double kOverlap =
    0.1;  // node spacings (and temporal windows); a leaf's list is valid this far beyond its borders

}  // namespace

/// The extent of each node along each axis, metres; time is converted to metres by `scale`.
struct InfluenceTree::NodeExtents {
    std::array<std::vector<double>, kAxes> from, to;
    std::array<double, kAxes> scale;

    explicit NodeExtents(const DeformationGraph& graph) : scale{1, 1, 1, graph.metres_per_frame()} {
        const double window = graph.config().temporal_window;
        for (const GraphNode& node : graph.nodes()) {
            for (size_t axis = 0; axis < kTime; ++axis) {
                from[axis].push_back(node.position[static_cast<Eigen::Index>(axis)]);
                to[axis].push_back(from[axis].back());
            }
            from[kTime].push_back(scale[kTime] * (node.time - window));
            to[kTime].push_back(scale[kTime] * (node.last_seen + window));
        }
    }
};

/// Part of space (metres) and time (frames), with the nodes that can influence points in it and the places in it.
struct InfluenceTree::Box {
    std::array<double, kAxes> low, high;
    std::vector<std::uint32_t> nodes, places;
    std::vector<double> node_distances;  // least distance of each node from the box, metres
    double nearest = 0;                  // of them
    std::array<double, kAxes> overlap;

    [[nodiscard]] double size(size_t axis) const { return high[axis] - low[axis]; }
    [[nodiscard]] bool is_finite() const {
        return std::all_of(low.begin(), low.end(), [](double x) { return x > -kInfinity; }) &&
               std::all_of(high.begin(), high.end(), [](double x) { return x < kInfinity; });
    }

    /// Adds the squares of the least and the greatest distance along an axis between the box's points and each node of
    /// `among`.
    void add_distances2(const NodeExtents& extents, std::span<const std::uint32_t> among, size_t axis,
                        std::vector<double>& least, std::vector<double>& greatest) const {
        const auto& from = extents.from[axis];
        const auto& to = extents.to[axis];
        const double scale = extents.scale[axis], begin = scale * (low[axis] - overlap[axis]),
                     end = scale * (high[axis] + overlap[axis]);
        for (size_t k = 0; k < among.size(); ++k) {
            const double near = std::max(0.0, std::max(begin - to[among[k]], from[among[k]] - end));
            const double far = std::max(0.0, std::max(end - to[among[k]], from[among[k]] - begin));
            least[k] += near * near;
            greatest[k] += far * far;
        }
    }

    /// Selects those of `among` that can influence a point of the box. @param least, greatest  squared distances of
    /// each
    void choose_nodes(std::span<const std::uint32_t> among, const std::vector<double>& least,
                      const std::vector<double>& greatest) {
        nearest = std::sqrt(*std::min_element(least.begin(), least.end()));
        std::array<double, kInfluences + 1> closest;  // of `greatest`, ascending
        closest.fill(kInfinity);
        for (double x : greatest) {
            if (x >= closest.back()) continue;
            for (double& y : closest) {
                if (x < y) std::swap(x, y);
            }
        }
        const double reach = std::sqrt(closest.back()) * (1 + kInfluenceMargin) + kSlack;
        for (size_t k = 0; k < among.size(); ++k) {
            if (least[k] <= reach * reach) nodes.push_back(among[k]), node_distances.push_back(std::sqrt(least[k]));
        }
    }

    /// The extent of a place along an axis.
    [[nodiscard]] static std::pair<double, double> extent(const DeformationGraph& graph, std::uint32_t index,
                                                          size_t axis) {
        const auto& place = graph.places()[index];
        if (axis == kTime) {
            const double around = kAroundTime * graph.config().temporal_window;
            return {place.created - around, place.last_seen + around};
        }
        const double around = kAround * graph.place_size(), x = place.position[static_cast<Eigen::Index>(axis)];
        return {x - around, x + around};
    }
    /// Selects those of `among` that reach into the box along an axis.
    void choose_places(const DeformationGraph& graph, std::span<const std::uint32_t> among, size_t axis) {
        for (const auto index : among) {
            const auto [from, to] = extent(graph, index, axis);
            if (to > low[axis] && from < high[axis]) places.push_back(index);
        }
    }
    [[nodiscard]] std::pair<double, double> extent_of_places(const DeformationGraph& graph, size_t axis) const {
        std::pair<double, double> all{kInfinity, -kInfinity};
        for (const auto index : places) {
            const auto [from, to] = extent(graph, index, axis);
            all = {std::min(all.first, from), std::max(all.second, to)};
        }
        return all;
    }

    /// Middle and length of the longest gap in time between nodes of the list, frames.
    [[nodiscard]] std::pair<double, double> pause(const DeformationGraph& graph) const {
        thread_local std::vector<double> middles;
        middles.clear();
        for (const auto i : nodes)
            middles.push_back(0.5 * (static_cast<double>(graph.nodes()[i].time) + graph.nodes()[i].last_seen));
        std::sort(middles.begin(), middles.end());
        std::pair<double, double> result{middles.front(), 0};
        for (size_t k = 1; k < middles.size(); ++k) {
            const double gap = middles[k] - middles[k - 1];
            if (gap > result.second) result = {0.5 * (middles[k] + middles[k - 1]), gap};
        }
        return result;
    }
};

InfluenceTree::InfluenceTree(const DeformationGraph& graph) {
    if (graph.nodes().empty()) return;
    metres_per_frame_ = graph.metres_per_frame();
    temporal_window_ = graph.config().temporal_window;
    const auto to_float = [](double x) { return static_cast<float>(x); };
    for (const auto& node : graph.nodes()) {
        const Eigen::Vector3d rest = node.t - node.R * node.position + node.position;
        const Eigen::Quaterniond q(node.R);
        nodes_.push_back({{to_float(q.x()), to_float(q.y()), to_float(q.z()), to_float(q.w())},
                          {to_float(rest.x()), to_float(rest.y()), to_float(rest.z()), 0}});
    }
    for (std::uint32_t i = 0; i < nodes_.size(); ++i) add_candidate(graph, i, 0);  // the list of all
    Box root;
    root.low.fill(-kInfinity);
    root.high.fill(kInfinity);
    root.nodes.resize(graph.nodes().size());
    std::iota(root.nodes.begin(), root.nodes.end(), 0u);
    root.node_distances.resize(root.nodes.size());
    const double spacing = static_cast<double>(graph.config().node_spacing);
    root.overlap.fill(kOverlap * spacing);
    root.overlap[kTime] = kOverlap * temporal_window_;
    root.places.resize(graph.places().size());
    std::iota(root.places.begin(), root.places.end(), 0u);
    build(graph, std::move(root));
}

void InfluenceTree::build(const DeformationGraph& graph, Box root) {
    const double spacing = static_cast<double>(graph.config().node_spacing);
    const NodeExtents extents(graph);
    std::vector<std::pair<size_t, Box>> open;  // with the branch that each is to become
    branches_.resize(1);
    open.push_back({0, std::move(root)});
    const auto split = [&](const Box& box, size_t branch, size_t axis, double at) {
        const auto children = static_cast<std::uint32_t>(branches_.size());
        branches_[branch] = {static_cast<float>(at), static_cast<std::uint32_t>(axis) + gpu::DEFORM_LINK * children};
        branches_.resize(branches_.size() + 2);
        thread_local std::vector<double> least, greatest, half_least, half_greatest;
        least.assign(box.nodes.size(), 0), greatest.assign(box.nodes.size(), 0);
        for (size_t other = 0; other < kAxes; ++other) {
            if (other != axis) box.add_distances2(extents, box.nodes, other, least, greatest);
        }
        for (const bool is_above : {false, true}) {
            Box half;
            half.low = box.low, half.high = box.high, half.overlap = box.overlap;
            (is_above ? half.low : half.high)[axis] = static_cast<double>(static_cast<float>(at));
            half_least = least, half_greatest = greatest;
            half.add_distances2(extents, box.nodes, axis, half_least, half_greatest);
            half.choose_nodes(box.nodes, half_least, half_greatest);
            half.choose_places(graph, box.places, axis);
            open.push_back({children + is_above, std::move(half)});
        }
    };
    while (!open.empty()) {
        auto [branch, box] = std::move(open.back());
        open.pop_back();
        const bool empty = box.places.empty();
        const bool far = empty && (box.nearest > kFarEmpty * spacing || !box.is_finite());
        if (box.nodes.size() <= (empty ? kFitList : kShortList) || far) {
            add_leaf(graph, branch, box);
            continue;
        }
        // cut off large empty parts of space and time
        bool cut = false;
        for (size_t axis = 0; axis < kAxes && !empty && !cut; ++axis) {
            const auto [from, to] = box.extent_of_places(graph, axis);
            const double length = axis == kTime ? temporal_window_ : spacing;
            const double first = (std::floor(from / length) - 1) * length, last = (std::ceil(to / length) + 1) * length;
            cut = true;
            if (first - box.low[axis] > length)
                split(box, branch, axis, first);
            else if (box.high[axis] - last > length)
                split(box, branch, axis, last);
            else
                cut = false;
        }
        if (cut) continue;
        // between visits, else across the longest side
        const auto [middle, frames] = box.pause(graph);
        const double pause = std::floor(middle) + 0.5;
        const size_t longest = box.size(0) >= box.size(1) && box.size(0) >= box.size(2) ? 0
                               : box.size(1) >= box.size(2)                             ? 1
                                                                                        : 2;
        if (frames > 2 * temporal_window_ && pause > box.low[kTime] && pause < box.high[kTime]) {
            split(box, branch, kTime, pause);
        } else if (box.size(longest) > (empty ? kSmallEmpty : kSmall) * spacing) {
            split(box, branch, longest, 0.5 * (box.low[longest] + box.high[longest]));
        } else {
            add_leaf(graph, branch, box);
        }
    }
}

void InfluenceTree::add_candidate(const DeformationGraph& graph, std::uint32_t index, double bound) {
    const auto& node = graph.nodes()[index];
    const Eigen::Vector3f p = node.position.cast<float>();
    candidates_.push_back({{p.x(), p.y(), p.z(), static_cast<float>(node.time)},
                           static_cast<float>(node.last_seen),
                           static_cast<float>(bound * bound),
                           index,
                           0});
}

void InfluenceTree::add_leaf(const DeformationGraph& graph, size_t branch, const Box& box) {
    std::array<float, kAxes> low, high;
    for (size_t i = 0; i < kAxes; ++i) {
        low[i] = static_cast<float>(box.low[i] - box.overlap[i]);
        high[i] = static_cast<float>(box.high[i] + box.overlap[i]);
    }
    std::uint32_t begin = 0, end = static_cast<std::uint32_t>(nodes_.size());
    if (box.nodes.size() <= kFitList || !box.places.empty()) {
        std::vector<std::pair<double, std::uint32_t>> sorted;
        for (size_t k = 0; k < box.nodes.size(); ++k)
            sorted.emplace_back(std::max(0.0, box.node_distances[k] - kSlack), box.nodes[k]);
        std::sort(sorted.begin(), sorted.end());
        begin = static_cast<std::uint32_t>(candidates_.size());
        for (const auto& [bound, i] : sorted) add_candidate(graph, i, bound);
        end = static_cast<std::uint32_t>(candidates_.size());
    }
    branches_[branch] = {0, gpu::DEFORM_LEAF + gpu::DEFORM_LINK * static_cast<std::uint32_t>(leaves_.size())};
    leaves_.push_back({{low[0], low[1], low[2], low[3]}, {high[0], high[1], high[2], high[3]}, begin, end, 0, 0});
}

std::span<const gpu::DeformCandidate> InfluenceTree::candidates(const Eigen::Vector3d& point,
                                                                std::uint32_t time) const {
    if (branches_.empty()) return {};
    const Eigen::Vector4f p(static_cast<float>(point.x()), static_cast<float>(point.y()), static_cast<float>(point.z()),
                            static_cast<float>(time));
    auto at = branches_[0];
    while (at.link % gpu::DEFORM_LINK != gpu::DEFORM_LEAF) {
        at = branches_[at.link / gpu::DEFORM_LINK +
                       (p[static_cast<Eigen::Index>(at.link % gpu::DEFORM_LINK)] >= at.split ? 1 : 0)];
    }
    const auto& leaf = leaves_[at.link / gpu::DEFORM_LINK];
    return std::span(candidates_).subspan(leaf.begin, leaf.end - leaf.begin);
}

}  // namespace posefusion
