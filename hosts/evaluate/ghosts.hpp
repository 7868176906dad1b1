#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "engine/core/image.hpp"
#include "engine/slam/slam.hpp"
#include "hosts/evaluate/cube.hpp"
#include "hosts/io/trajectory.hpp"

/// Surfels that are not part of the static scene: remains of people who walked through ("ghosts").
namespace posefusion {

struct GhostConfig {
    float max_distance = 0.05f;   ///< a surfel farther than this from the true static surface is a ghost, metres
    float point_spacing = 0.01f;  ///< the true surface is kept as one point per cube of this side, metres
    int mask_margin =
        2;  ///< border of people's masks that does not count as static, pixels: depth edges are not that sharp
    float noise_sigmas = 3.0f;  ///< a ghost nearer to the surface than this many standard deviations of the depth noise
                                ///< at its range may be noise
    DepthNoise noise;
    float max_range = 5.0f;  ///< farthest depth that is mapped, metres
};

/// The true static surface: the union of the static depth points of all frames at their true poses.
class StaticSurface {
public:
    explicit StaticSurface(const GhostConfig& config = {});

    /// @param labels  people, non-zero; empty = no people
    void add(const DepthImage& depth, const LabelImage& labels, const Intrinsics& camera,
             const Eigen::Isometry3d& T_world_camera);
    /// Whether the surface has a point within `limit` metres of `point`; limit <= reach().
    [[nodiscard]] bool within(const Eigen::Vector3d& point, float limit) const;
    /// The largest limit that count_ghosts() needs: max_distance or the noise at max_range.
    [[nodiscard]] float reach() const { return reach_; }
    [[nodiscard]] std::size_t size() const { return occupied_.size(); }  ///< points kept

private:
    GhostConfig config_;
    float reach_;
    std::unordered_set<Cube, CubeHash> occupied_;                              ///< cubes of point_spacing with a point
    std::unordered_map<Cube, std::vector<Eigen::Vector3f>, CubeHash> points_;  ///< by cubes of reach_
};

struct GhostCount {
    std::size_t surfels = 0;  ///< examined
    std::size_t ghosts = 0;   ///< of these, farther than max_distance from the true static surface
    std::size_t noise = 0;    ///< of the ghosts, those that the depth noise at their range explains
    [[nodiscard]] double fraction() const {
        return surfels == 0 ? 0 : static_cast<double>(ghosts) / static_cast<double>(surfels);
    }
};

/// @param T_truth_map  from the map's world to that of the true poses
/// @param true_poses   all camera poses a surfel may have been measured from: the nearest one that sees it
///                     gives its range
/// @param is_ghost     if not null, gets a flag per surfel
[[nodiscard]] GhostCount count_ghosts(const StaticSurface& surface, const std::vector<Surfel>& map,
                                      const Eigen::Isometry3d& T_truth_map, const Trajectory& true_poses,
                                      const Intrinsics& camera, const GhostConfig& config = {},
                                      std::vector<std::uint8_t>* is_ghost = nullptr);

}  // namespace posefusion
