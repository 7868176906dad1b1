#include "segmentation/refinement.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace posefusion {
namespace {

struct Ballot {
    std::uint8_t label = 0;
    float weight = 0;
};

/// Sums weights per label; at most nine labels can meet.
class Vote {
public:
    void cast(std::uint8_t label, float weight) {
        for (int i = 0; i < count_; ++i)
            if (ballots_[static_cast<std::size_t>(i)].label == label) {
                ballots_[static_cast<std::size_t>(i)].weight += weight;
                return;
            }
        ballots_[static_cast<std::size_t>(count_++)] = {label, weight};
    }
    [[nodiscard]] std::uint8_t winner() const {
        const auto end = ballots_.begin() + count_;
        return std::max_element(ballots_.begin(), end,
                                [](const Ballot& a, const Ballot& b) { return a.weight < b.weight; })
            ->label;
    }

private:
    std::array<Ballot, 9> ballots_{};
    int count_ = 0;
};

bool uniform_around(const NodeGrid& grid, const std::vector<std::uint8_t>& labels, int x, int y) {
    const std::uint8_t label = labels[grid.index(x, y)];
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
            if (grid.contains(x + dx, y + dy) && labels[grid.index(x + dx, y + dy)] != label) return false;
    return true;
}

std::uint8_t vote(const NodeGrid& grid, const std::vector<std::uint8_t>& labels, int x, int y, float px, float py,
                  float z, const Rgb8& c, const RefinementConfig& config) {
    constexpr float kUnlike = 1e-3f;  // a pixel unlike all nodes follows the nearest
    const Eigen::Vector3f color(c.r / 255.0f, c.g / 255.0f, c.b / 255.0f);
    const float depth_sigma = config.depth_sigma + 2 * grid.noise.sigma(z);
    Vote votes;
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
            if (!grid.contains(x + dx, y + dy)) continue;
            const Node& node = grid.at(x + dx, y + dy);
            const float ex = static_cast<float>(x + dx) - px, ey = static_cast<float>(y + dy) - py;
            float cost = (ex * ex + ey * ey);
            cost +=
                (node.color - color).squaredNorm() / (config.color_sigma * config.color_sigma) * (z > 0 ? 0.25f : 1.0f);
            float weight = std::exp(-0.5f * cost);
            if (z > 0 && node.depth > 0) {
                const float step = (node.depth - z) / depth_sigma;
                weight *= std::exp(-0.5f * step * step);
            } else if (z > 0) {
                weight *= 0.1f;  // a node without depth says little about a pixel with depth
            }
            votes.cast(labels[grid.index(x + dx, y + dy)], weight + kUnlike * std::exp(-0.5f * (ex * ex + ey * ey)));
        }
    return votes.winner();
}

}  // namespace

LabelImage refine_labels(const NodeGrid& grid, const std::vector<std::uint8_t>& labels, const ColorImage& color,
                         const DepthImage& depth, const RefinementConfig& config) {
    LabelImage image(depth.width(), depth.height());
    const float half = 0.5f * static_cast<float>(grid.step - 1);
    for (int y = 0; y < grid.height; ++y)
        for (int x = 0; x < grid.width; ++x) {
            const bool uniform = uniform_around(grid, labels, x, y);
            const std::uint8_t label = labels[grid.index(x, y)];
            if (uniform && label == 0) continue;
            const int u1 = std::min((x + 1) * grid.step, depth.width());
            const int v1 = std::min((y + 1) * grid.step, depth.height());
            for (int v = y * grid.step; v < v1; ++v)
                for (int u = x * grid.step; u < u1; ++u) {
                    if (uniform) {
                        image(u, v) = label;
                        continue;
                    }
                    const float px = (static_cast<float>(u) - half) / static_cast<float>(grid.step);
                    const float py = (static_cast<float>(v) - half) / static_cast<float>(grid.step);
                    const float z = std::isfinite(depth(u, v)) ? depth(u, v) : 0;
                    image(u, v) = vote(grid, labels, x, y, px, py, z, color(u, v), config);
                }
        }
    return image;
}

}  // namespace posefusion
