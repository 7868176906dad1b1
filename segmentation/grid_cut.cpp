#include "segmentation/grid_cut.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc/detail/gcgraph.hpp>

namespace posefusion {
namespace {

/// Whole-number capacities: sums are exact, so the cut cannot depend on rounding.
constexpr float kCapacityUnits = 1000;

/// Depth step between two nodes that the surfaces' own slant does not explain, metres.
float depth_step(const Node& a, const Node& b) {
    const Eigen::Vector3f between = b.point - a.point;
    const bool has_a = !a.normal.isZero(), has_b = !b.normal.isZero();
    if (has_a || has_b) {
        float step = 1e9f;
        if (has_a) step = std::abs(a.normal.dot(between));
        if (has_b) step = std::min(step, std::abs(b.normal.dot(between)));
        return step;
    }
    return std::abs(a.depth - b.depth);
}

/// Eq. (2), C = exp(-(length / sigma)^2): the length is the step in depth, sigma grows with the noise there, and where
/// depth says "same surface" the colours may lower the weight as well.
float edge_weight(const Node& a, const Node& b, const DepthNoise& noise, const SmoothnessConfig& config) {
    const float color = (a.color - b.color).squaredNorm() / (config.color_sigma * config.color_sigma);
    const float by_color = std::exp(-color);
    if (a.depth <= 0 || b.depth <= 0) return config.weight * std::max(by_color, 0.1f);
    const float step = depth_step(a, b);
    const float sigma = config.depth_sigma + 2 * noise.sigma(std::max(a.depth, b.depth));
    const float by_depth = std::exp(-(step * step) / (sigma * sigma));
    return config.weight * by_depth * (config.color_floor + (1 - config.color_floor) * by_color);
}

}  // namespace

std::vector<std::uint8_t> cut_grid(const NodeGrid& grid, const std::vector<float>& preference,
                                   const SmoothnessConfig& config) {
    const std::size_t count = grid.nodes.size();
    std::vector<std::uint8_t> labels(count, 0);
    if (count < 2) {
        for (std::size_t i = 0; i < count; ++i) labels[i] = preference[i] > 0;
        return labels;
    }
    cv::detail::GCGraph<int> graph(static_cast<unsigned>(count), static_cast<unsigned>(8 * count));
    for (std::size_t i = 0; i < count; ++i) {
        const int capacity = static_cast<int>(std::lround(std::abs(preference[i]) * kCapacityUnits));
        const int node = graph.addVtx();
        // the cost of overruling the preference, eq. (3)
        graph.addTermWeights(node, preference[i] > 0 ? capacity : 0, preference[i] > 0 ? 0 : capacity);
    }
    struct Step {
        int dx, dy;
        float share;  ///< longer edges weigh less, so that the border's length counts the same in every direction
    };
    constexpr std::array<Step, 4> kSteps{{{1, 0, 1.0f}, {0, 1, 1.0f}, {1, 1, 0.7071f}, {-1, 1, 0.7071f}}};
    for (int y = 0; y < grid.height; ++y)
        for (int x = 0; x < grid.width; ++x)
            for (const Step& s : kSteps) {
                if (!grid.contains(x + s.dx, y + s.dy)) continue;
                const float weight =
                    s.share * edge_weight(grid.at(x, y), grid.at(x + s.dx, y + s.dy), grid.noise, config);
                const int capacity = static_cast<int>(std::lround(weight * kCapacityUnits));
                if (capacity > 0)
                    graph.addEdges(static_cast<int>(grid.index(x, y)), static_cast<int>(grid.index(x + s.dx, y + s.dy)),
                                   capacity, capacity);
            }
    graph.addEdges(0, 1, 0, 0);  // GCGraph insists on at least one edge
    graph.maxFlow();
    for (std::size_t i = 0; i < count; ++i) labels[i] = graph.inSourceSegment(static_cast<int>(i));
    return labels;
}

}  // namespace posefusion
