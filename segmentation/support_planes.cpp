#include "segmentation/support_planes.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace posefusion {
namespace {

using Eigen::Vector3f;

float cosine(float degrees) { return std::cos(degrees * std::numbers::pi_v<float> / 180); }

/// Mean of the normals around the image's up, narrowed step by step.
std::optional<Vector3f> find_up(const std::vector<const Node*>& nodes, const SupportConfig& config) {
    constexpr int kFewest = 50;
    constexpr int kSteps = 4;
    Vector3f up(0, -1, 0);
    for (int step = 0; step < kSteps; ++step) {
        const float share = static_cast<float>(step) / (kSteps - 1);
        const float least = cosine(config.max_tilt + share * (config.normal_spread - config.max_tilt));
        Vector3f sum = Vector3f::Zero();
        int count = 0;
        for (const Node* node : nodes)
            if (node->normal.dot(up) > least) sum += node->normal, ++count;
        if (count < kFewest) return std::nullopt;
        up = sum.normalized();
    }
    return up;
}

/// Least squares through the nodes near a plane, twice.
Plane refine(Plane plane, const std::vector<const Node*>& nodes, const DepthNoise& noise, const SupportConfig& config) {
    const float least = cosine(config.normal_spread);
    for (int round = 0; round < 2; ++round) {
        Eigen::Vector3d mean = Eigen::Vector3d::Zero();
        Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
        int count = 0;
        for (const Node* node : nodes) {
            if (node->normal.dot(plane.normal) < least) continue;
            if (std::abs(plane.height(node->point)) > 2 * config.thickness + 2 * noise.sigma(node->depth)) continue;
            const Eigen::Vector3d p = node->point.cast<double>();
            mean += p;
            scatter += p * p.transpose();
            ++count;
        }
        if (count < 10) return plane;
        mean /= count;
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(scatter / count - mean * mean.transpose());
        Vector3f normal = solver.eigenvectors().col(0).cast<float>();
        if (normal.dot(plane.normal) < 0) normal = -normal;
        if (normal.dot(plane.normal) < least) return plane;  // a narrow strip does not fix the tilt
        plane = {normal, normal.dot(mean.cast<float>().eval())};
    }
    return plane;
}

}  // namespace

std::vector<Plane> find_support_planes(const NodeGrid& grid, const std::vector<bool>& free,
                                       const SupportConfig& config) {
    std::vector<const Node*> nodes;
    for (std::size_t i = 0; i < grid.nodes.size(); ++i)
        if (free[i] && !grid.nodes[i].normal.isZero()) nodes.push_back(&grid.nodes[i]);
    const auto up = find_up(nodes, config);
    if (!up) return {};

    // Areas over height above the lowest point, in bins.
    constexpr float kRange = 4;  // metres below and above the camera
    std::vector<float> area(static_cast<std::size_t>(2 * kRange / config.bin) + 1, 0.0f);
    const float least = cosine(config.normal_spread);
    for (const Node* node : nodes) {
        const float height = up->dot(node->point) + kRange;
        if (node->normal.dot(*up) < least || height < 0) continue;
        const auto bin = static_cast<std::size_t>(height / config.bin);
        if (bin >= area.size()) continue;
        const float side = node->depth / grid.camera.fx;
        const float slant = std::max(-node->normal.dot(node->point) / node->point.norm(), 0.1f);
        area[bin] += side * side / slant;
    }
    std::vector<Plane> planes;
    while (static_cast<int>(planes.size()) < config.max_planes) {
        std::size_t best = 0;
        float best_area = 0;
        for (std::size_t b = 1; b + 1 < area.size(); ++b) {
            const float sum = area[b - 1] + area[b] + area[b + 1];
            if (sum > best_area) best_area = sum, best = b;
        }
        if (best_area < config.min_area) break;
        const float height = (static_cast<float>(best) + 0.5f) * config.bin - kRange;
        planes.push_back(refine({*up, height}, nodes, grid.noise, config));
        for (std::size_t b = best > 2 ? best - 2 : 0; b <= best + 2 && b < area.size(); ++b) area[b] = 0;
    }
    return planes;
}

bool on_support(const Node& node, const std::vector<Plane>& planes, const DepthNoise& noise,
                const SupportConfig& config) {
    constexpr float kSpread = 2;  // normals near feet and hands are smoothed by the filter window
    if (node.depth <= 0) return false;
    const bool has_normal = !node.normal.isZero();
    const float least = cosine(kSpread * config.normal_spread);
    for (const Plane& plane : planes) {
        if (std::abs(plane.height(node.point)) > config.thickness + noise.sigma(node.depth)) continue;
        if (!has_normal || node.normal.dot(plane.normal) > least) return true;
    }
    return false;
}

}  // namespace posefusion
