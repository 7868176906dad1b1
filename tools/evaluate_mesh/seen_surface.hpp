#pragma once
#include <Eigen/Geometry>
#include <filesystem>
#include <vector>

#include "hosts/io/recording.hpp"
#include "tools/evaluate_objects/object_truth.hpp"

namespace posefusion {

struct SeenSurfaceConfig {
    /// A point was measured in a frame if nothing of the surface is before it, and nothing else: the depth measured
    /// there is its own but for this much, constant + per_square z^2 at a depth of z metres, the noise of structured
    /// light three times.
    float constant = 0.01f, per_square = 0.006f;
    float rim = 0.005f;     ///< metres before the point in which its own surface may be
    float farthest = 5.0f;  ///< metres; beyond, depth is not used (PreprocessConfig::depth_max)
    int least_frames = 5;   ///< less is no surfel
    int every = 2;          ///< frames are looked at one in so many
};

/// Those of the points of the true surface that the depth images of a recording show, neither behind people nor out of
/// range. @param points  world of groundtruth.txt, as `truth`  Throws Error: the recording has no true poses.
[[nodiscard]] std::vector<Eigen::Vector3f> seen_points(const Recording& recording, const TrueMesh& truth,
                                                       const std::vector<Eigen::Vector3f>& points,
                                                       const SeenSurfaceConfig& config = {});

}  // namespace posefusion
