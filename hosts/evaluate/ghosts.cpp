#include "hosts/evaluate/ghosts.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/error.hpp"
#include "engine/core/pinhole.hpp"

namespace posefusion {
namespace {

/// Pixels of people, grown by `margin` in both directions.
LabelImage grow(const LabelImage& labels, int margin) {
    LabelImage grown(labels.width(), labels.height());
    for (int v = 0; v < labels.height(); ++v) {
        for (int u = 0; u < labels.width(); ++u) {
            if (labels(u, v) == 0) continue;
            const int v_end = std::min(v + margin, labels.height() - 1),
                      u_end = std::min(u + margin, labels.width() - 1);
            for (int y = std::max(v - margin, 0); y <= v_end; ++y)
                for (int x = std::max(u - margin, 0); x <= u_end; ++x) grown(x, y) = 1;
        }
    }
    return grown;
}

/// Smallest depth at which one of the cameras has the point in its image; max_range if there is none.
float nearest_depth(const Eigen::Vector3d& point, const std::vector<Eigen::Isometry3d>& T_camera_world,
                    const Intrinsics& camera, float max_range) {
    double nearest = max_range;
    for (const Eigen::Isometry3d& T : T_camera_world) {
        const Eigen::Vector3d p = T * point;
        if (p.z() > 0 && p.z() < nearest && in_image(project(p, camera), camera)) nearest = p.z();
    }
    return static_cast<float>(nearest);
}

}  // namespace

StaticSurface::StaticSurface(const GhostConfig& config)
    : config_(config),
      reach_(std::max(config.max_distance, config.noise_sigmas * config.noise.sigma(config.max_range))) {}

void StaticSurface::add(const DepthImage& depth, const LabelImage& labels, const Intrinsics& camera,
                        const Eigen::Isometry3d& T_world_camera) {
    if (!labels.empty() && (labels.width() != depth.width() || labels.height() != depth.height()))
        throw Error("mask and depth image differ in size");
    const LabelImage people =
        labels.empty() ? LabelImage(depth.width(), depth.height()) : grow(labels, config_.mask_margin);
    // Neighbouring pixels often share a cube: remembering the last one saves most of the look-ups.
    std::vector<Cube> above(static_cast<std::size_t>(depth.width()),
                            Cube{std::numeric_limits<std::int32_t>::min(), 0, 0});
    for (int v = 0; v < depth.height(); ++v) {
        Cube left{std::numeric_limits<std::int32_t>::min(), 0, 0};
        for (int u = 0; u < depth.width(); ++u) {
            const float d = depth(u, v);
            if (d <= 0 || people(u, v) != 0) continue;
            const Eigen::Vector3d point =
                T_world_camera * back_project(static_cast<float>(u), static_cast<float>(v), d, camera).cast<double>();
            const Cube cube = cube_of(point, config_.point_spacing);
            Cube& upper = above[static_cast<std::size_t>(u)];
            const bool known = cube == left || cube == upper;
            left = upper = cube;
            if (known) continue;
            if (occupied_.insert(cube).second) points_[cube_of(point, reach_)].push_back(point.cast<float>());
        }
    }
}

bool StaticSurface::within(const Eigen::Vector3d& point, float limit) const {
    if (limit > reach_) throw Error("the static surface was not made for distances this large");
    const Eigen::Vector3f p = point.cast<float>();
    const float limit2 = limit * limit;
    const auto found_in = [&](const Cube& cube) {
        const auto cell = points_.find(cube);
        return cell != points_.end() &&
               std::any_of(cell->second.begin(), cell->second.end(),
                           [&](const Eigen::Vector3f& q) { return (q - p).squaredNorm() <= limit2; });
    };
    const Cube centre = cube_of(point, reach_);
    if (found_in(centre)) return true;
    for (std::int32_t z = centre[2] - 1; z <= centre[2] + 1; ++z)
        for (std::int32_t y = centre[1] - 1; y <= centre[1] + 1; ++y)
            for (std::int32_t x = centre[0] - 1; x <= centre[0] + 1; ++x)
                if (const Cube cube{x, y, z}; cube != centre && found_in(cube)) return true;
    return false;
}

GhostCount count_ghosts(const StaticSurface& surface, const std::vector<Surfel>& map,
                        const Eigen::Isometry3d& T_truth_map, const Trajectory& true_poses, const Intrinsics& camera,
                        const GhostConfig& config, std::vector<std::uint8_t>* is_ghost) {
    std::vector<Eigen::Isometry3d> T_camera_world;
    for (const StampedPose& pose : true_poses) T_camera_world.push_back(pose.T_world_camera.inverse());
    if (is_ghost != nullptr) is_ghost->assign(map.size(), 0);

    GhostCount count;
    count.surfels = map.size();
    for (std::size_t i = 0; i < map.size(); ++i) {
        const Eigen::Vector3d point = T_truth_map * map[i].position.cast<double>();
        if (surface.within(point, config.max_distance)) continue;
        ++count.ghosts;
        if (is_ghost != nullptr) (*is_ghost)[i] = 1;
        const float depth = nearest_depth(point, T_camera_world, camera, config.max_range);
        const float noise = std::min(config.noise_sigmas * config.noise.sigma(depth), surface.reach());
        if (noise > config.max_distance && surface.within(point, noise)) ++count.noise;
    }
    return count;
}

}  // namespace posefusion
