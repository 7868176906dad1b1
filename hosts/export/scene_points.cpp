#include "hosts/export/scene_points.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace posefusion {
namespace {

constexpr float kSmallestCell = 0.005f;  ///< metres; surfels are hardly smaller
constexpr float kLeastGrowth = 1.1f;     ///< of the cells from one try to the next
/// A measurement is of the point if it differs by less: noise of depth cameras grows with the distance.
constexpr float kDepthTolerance = 0.01f, kRelativeDepthTolerance = 0.02f;  ///< metres; part of the depth
constexpr float kMostSlanted = 0.2f;  ///< cosine of the angle between normal and line of sight

/// 21 bits per coordinate: 10 km in cells of 5 mm; what is farther shares the outermost cells.
std::uint64_t cell_of(const Eigen::Vector3f& position, float size) {
    constexpr float kMost = static_cast<float>((1 << 20) - 1);
    std::uint64_t key = 0;
    for (int i = 0; i < 3; ++i) {
        const float cell = std::clamp(std::floor(position[i] / size), -kMost, kMost);
        key = key << 21 | static_cast<std::uint64_t>(static_cast<std::int64_t>(cell) + (1 << 20));
    }
    return key;
}

/// Positions of the most confident surfel of each cell, ascending.
std::vector<std::size_t> best_of_cells(const std::vector<Surfel>& surfels, float size) {
    std::unordered_map<std::uint64_t, std::size_t> best;
    for (std::size_t i = 0; i < surfels.size(); ++i) {
        const auto [entry, first] = best.try_emplace(cell_of(surfels[i].position, size), i);
        if (!first && surfels[i].confidence > surfels[entry->second].confidence) entry->second = i;
    }
    std::vector<std::size_t> places;
    places.reserve(best.size());
    for (const auto& [cell, place] : best) places.push_back(place);
    std::sort(places.begin(), places.end());
    return places;
}

bool faces(const Surfel& point, const Eigen::Vector3f& eye) {
    const Eigen::Vector3f sight = eye - point.position;
    return point.normal.dot(sight) > kMostSlanted * sight.norm();
}

}  // namespace

std::vector<Surfel> evenly_spread(const std::vector<Surfel>& surfels, std::size_t most) {
    std::vector<Surfel> finite;
    std::copy_if(surfels.begin(), surfels.end(), std::back_inserter(finite),
                 [](const Surfel& s) { return s.position.allFinite() && s.normal.allFinite(); });
    float cell = kSmallestCell;
    while (finite.size() > most && most > 0) {
        const std::vector<std::size_t> places = best_of_cells(finite, cell);
        const float excess = static_cast<float>(places.size()) / static_cast<float>(most);
        if (excess <= 1) {
            std::vector<Surfel> chosen;
            for (const std::size_t place : places) chosen.push_back(finite[place]);
            return chosen;
        }
        cell *= std::max(kLeastGrowth, std::sqrt(excess));  // the number of cells on a surface goes with their area
    }
    return finite;
}

std::vector<PointInView> points_in_view(const std::vector<Surfel>& points, const View& view, const Camera& camera) {
    const Eigen::Isometry3f T_camera_world = view.T_world_camera.inverse().cast<float>();
    const Eigen::Vector3f eye = view.T_world_camera.translation().cast<float>();
    std::vector<PointInView> seen;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const Eigen::Vector3f point = T_camera_world * points[i].position;
        const auto pixel = pixel_of(point, camera);
        if (!pixel || !faces(points[i], eye)) continue;
        const auto u = static_cast<int>(std::lround(pixel->x())), v = static_cast<int>(std::lround(pixel->y()));
        if (!view.people.empty() && view.people(u, v) != 0) continue;
        const float measured = view.depth(u, v);
        if (!(measured > 0) || std::abs(measured - point.z()) > kDepthTolerance + kRelativeDepthTolerance * point.z())
            continue;
        seen.push_back({static_cast<std::uint32_t>(i), *pixel});
    }
    return seen;
}

}  // namespace posefusion
