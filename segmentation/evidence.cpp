#include "segmentation/evidence.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "engine/core/pinhole.hpp"

namespace posefusion {
namespace {

constexpr float kFar = std::numeric_limits<float>::max();

/// Distances of all nodes with depth to a body; kFar where it does not matter.
std::vector<float> distances_to(const BodyVolume& body, const NodeGrid& grid, float margin) {
    std::vector<float> distance(grid.nodes.size(), kFar);
    const float limit = body.extent() + margin;
    for (std::size_t i = 0; i < grid.nodes.size(); ++i) {
        const Node& node = grid.nodes[i];
        if (node.depth > 0 && (node.point - body.center()).squaredNorm() < limit * limit)
            distance[i] = body.distance(node.point);
    }
    return distance;
}

/// Whether something new is between the camera and the remembered static surface. Things too near for the depth camera
/// are recognised by their colour; the shadows of near things have no depth either, but show the colour of the surface.
bool is_newcomer(const Node& node, const Memory& past, const DepthNoise& noise, const EvidenceConfig& config) {
    if (node.depth <= 0) return past.static_depth > 0 && past.color_change > config.color_changed;
    if (past.nearest_static <= 0) return false;
    return node.depth < past.nearest_static - config.step_in_front - 4 * noise.sigma(node.depth);
}

/// Region growing from the open nodes to their four neighbours: `join(from, i, x, y)` says whether the node i at (x, y)
/// beside `from` joins the region; it must say so only once per node.
template <class Join>
void spread(const NodeGrid& grid, std::vector<std::pair<int, int>> open, Join join) {
    constexpr std::array<std::pair<int, int>, 4> kSides{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
    while (!open.empty()) {
        const auto [x, y] = open.back();
        open.pop_back();
        const Node& from = grid.at(x, y);
        for (const auto& [dx, dy] : kSides) {
            if (grid.contains(x + dx, y + dy) && join(from, grid.index(x + dx, y + dy), x + dx, y + dy))
                open.push_back({x + dx, y + dy});
        }
    }
}

/// Newcomers at the body or connected to such ones.
std::vector<bool> find_newcomers(const BodyVolume& body, const std::vector<float>& distance, const NodeGrid& grid,
                                 const std::vector<Memory>& memory, const EvidenceConfig& config) {
    std::vector<bool> joined(grid.nodes.size(), false);
    std::vector<std::pair<int, int>> open;
    for (int y = 0; y < grid.height; ++y)
        for (int x = 0; x < grid.width; ++x) {
            const std::size_t i = grid.index(x, y);
            if (distance[i] < config.motion_near && is_newcomer(grid.nodes[i], memory[i], grid.noise, config))
                joined[i] = true, open.push_back({x, y});
        }
    spread(grid, std::move(open), [&](const Node& from, std::size_t i, int x, int y) {
        const Node& node = grid.nodes[i];
        if (joined[i] || !is_newcomer(node, memory[i], grid.noise, config)) return false;
        if (node.depth > 0 && from.depth > 0 &&
            std::abs(node.depth - from.depth) > config.step_in_front + 2 * grid.noise.sigma(from.depth))
            return false;
        const float away = node.depth > 0
                               ? body.distance(node.point)
                               : body.outline_distance(static_cast<float>(x), static_cast<float>(y), grid.camera);
        joined[i] = away <= config.motion_reach;
        return static_cast<bool>(joined[i]);
    });
    return joined;
}

/// The contribution of memory to the evidence from the distance to the body.
float add_memory(float value, bool newcomer, const Node& node, const Memory& past, const PersonTrack& track,
                 const DepthNoise& depth_noise, const EvidenceConfig& config) {
    const float weight = track.detected ? config.memory_detected : config.memory_carried;
    const float noise = 2 * depth_noise.sigma(node.depth);
    if (newcomer) value = std::max(value, config.motion_floor) + config.motion;
    if (past.person == track.id && std::abs(past.person_depth - node.depth) < config.person_tolerance + noise)
        value = std::max(value, config.memory_floor) + weight;
    if (past.static_depth > 0 && std::abs(past.static_depth - node.depth) < config.static_tolerance + noise)
        value -= weight;
    return value;
}

float judge_by_outline(const BodyVolume& body, const Node& node, float x, float y, const NodeGrid& grid,
                       const EvidenceConfig& config) {
    const float limit = config.outline_limit;
    const float outline = body.outline_distance(x, y, grid.camera) + config.outline_inset;
    float value = std::clamp(-outline / config.outline_scale, -limit, limit);
    if (node.behind > 0 && value > -limit) {
        const Eigen::Vector3f point = back_project(x, y, node.behind, grid.camera);
        value += std::clamp((config.border - body.distance(point)) / config.scale, -limit, limit);
    }
    return value;
}

/// What hides joints of a person is static, unless it is the person's own arm: with full weight where the joint is
/// hidden, with less weight as far as the surface continues without a step in depth.
void deny_occluders(const PersonTrack& track, const BodyVolume& body, const NodeGrid& grid, std::uint8_t person,
                    const EvidenceConfig& config, Evidence& evidence) {
    std::vector<bool> reached(grid.nodes.size(), false);
    std::vector<std::pair<int, int>> open;
    for (const Eigen::Vector3f& point : track.skeleton.occluders) {
        if (body.seen_distance(point) < config.border) continue;
        const Eigen::Vector2f at = project(point, grid.camera);
        const int x = static_cast<int>(std::lround(at.x())), y = static_cast<int>(std::lround(at.y()));
        if (!grid.contains(x, y)) continue;
        const std::size_t i = grid.index(x, y);
        if (std::abs(grid.nodes[i].depth - point.z()) > config.step_in_front || reached[i]) continue;
        if (evidence.person[i] == person) evidence.preference[i] = -config.static_limit;
        reached[i] = true;
        open.push_back({x, y});
    }
    spread(grid, std::move(open), [&](const Node& from, std::size_t i, int, int) {
        const Node& node = grid.nodes[i];
        if (reached[i] || evidence.person[i] != person || node.depth <= 0) return false;
        if (std::abs(node.depth - from.depth) > config.hiding_step + grid.noise.sigma(from.depth)) return false;
        if (body.seen_distance(node.point) < config.border) return false;
        reached[i] = true;
        evidence.preference[i] -= config.hiding;
        return true;
    });
}

}  // namespace

Evidence gather_evidence(const NodeGrid& grid, const std::vector<PersonTrack>& tracks,
                         const std::vector<Memory>& memory, const EvidenceConfig& config,
                         const SupportConfig& support) {
    Evidence evidence;
    evidence.preference.assign(grid.nodes.size(), -config.static_limit);
    evidence.person.assign(grid.nodes.size(), 0);

    std::vector<BodyVolume> bodies;
    std::vector<std::vector<float>> distance;
    std::vector<bool> free(grid.nodes.size(), true);
    for (const PersonTrack& track : tracks) {
        bodies.emplace_back(track.skeleton);
        distance.push_back(distances_to(bodies.back(), grid, config.margin));
        for (std::size_t i = 0; i < free.size(); ++i)
            if (distance.back()[i] < config.away) free[i] = false;
    }
    const std::vector<Plane> planes = find_support_planes(grid, free, support);
    std::vector<bool> supported(grid.nodes.size(), false);
    for (std::size_t i = 0; i < supported.size(); ++i)
        supported[i] = on_support(grid.nodes[i], planes, grid.noise, support);

    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const BodyVolume& body = bodies[b];
        const std::vector<bool> newcomer = find_newcomers(body, distance[b], grid, memory, config);
        for (int y = 0; y < grid.height; ++y)
            for (int x = 0; x < grid.width; ++x) {
                const std::size_t i = grid.index(x, y);
                const Node& node = grid.nodes[i];
                float value = -config.static_limit;
                if (node.depth > 0) {
                    if (distance[b][i] == kFar && !newcomer[i]) continue;
                    // eq. (3), with the distance in space instead of in the image
                    value = std::clamp((config.border - distance[b][i]) / config.scale, -config.static_limit,
                                       config.person_limit);
                    if (value < config.ends && !supported[i] && body.ends_distance(node.point) < 0) value = config.ends;
                    if (value < config.reach && body.reach_distance(node.point) < 0) value = config.reach;
                    value = add_memory(value, newcomer[i], node, memory[i], tracks[b], grid.noise, config);
                    if (supported[i]) value -= config.support;
                } else {
                    value = judge_by_outline(body, node, static_cast<float>(x), static_cast<float>(y), grid, config);
                    if (newcomer[i]) value = std::max(value, config.motion_floor) + config.motion;
                    if (memory[i].static_depth > 0 && memory[i].color_change < config.color_same)
                        value -= config.memory_detected;
                }
                if (value > evidence.preference[i]) {
                    evidence.preference[i] = value;
                    evidence.person[i] = static_cast<std::uint8_t>(b + 1);
                }
            }
    }
    for (std::size_t b = 0; b < bodies.size(); ++b)
        deny_occluders(tracks[b], bodies[b], grid, static_cast<std::uint8_t>(b + 1), config, evidence);
    return evidence;
}

}  // namespace posefusion
