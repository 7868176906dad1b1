#pragma once
#include <Eigen/Geometry>
#include <filesystem>
#include <vector>

#include "hosts/io/recording.hpp"
#include "tools/evaluate_objects/object_truth.hpp"

namespace posefusion {

struct SeenSurfaceConfig {
    /// A point was seen in a frame if the depth measured there is its own but for this much, at a depth of z metres:
    /// constant + per_square z^2, the noise of structured light three times.
    float constant = 0.01f, per_square = 0.006f;
    float farthest = 5.0f;  ///< metres; beyond, depth is not used (PreprocessConfig::depth_max)
    int least_frames = 5;   ///< less is no surfel
    int every = 2;          ///< of the frames, so many
};

/// Those of the points that the depth images of a recording show, neither behind people nor out of range.
/// @param points  world of groundtruth.txt  Throws Error: the recording lacks true poses, or masks of people.
[[nodiscard]] std::vector<Eigen::Vector3f> seen_points(const Recording& recording,
                                                       const std::vector<Eigen::Vector3f>& points,
                                                       const SeenSurfaceConfig& config = {});

}  // namespace posefusion
