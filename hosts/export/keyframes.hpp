#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "engine/core/image.hpp"

/// The choice of the frames of a run that are worth exporting.
namespace posefusion {

struct KeyframeConfig {
    /// The next view is one from which the scene looks different: the camera has moved by `distance` or turned by
    /// `angle` since the last one.
    float distance = 0.1f;  ///< metres
    float angle = 10;       ///< degrees
    /// Of the frames within this part of a step from there the sharpest is taken.
    float window = 0.5f;
    /// A frame with less than this part of the median sharpness of its neighbours is blurred, and never taken.
    double blurred = 0.5;
    std::size_t neighbours = 15;  ///< before and after it
};

/// How sharp an image is: the variance of its Laplacian (Pech-Pacheco et al., ICPR 2000), at half the size, where the
/// noise of the sensor has gone and blur by motion has not. It depends on what is seen, and says something only in
/// comparison with images of the same scene. @param labels  pixels with a label do not count: people move, and are cut
/// out; empty: there are none  @return 0 if nothing is left
[[nodiscard]] double sharpness(const ColorImage& color, const LabelImage& labels = {});

struct KeyframeCandidate {
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    double sharpness = 0;
};

/// @param candidates  in order of time  @return positions in it, ascending
[[nodiscard]] std::vector<std::size_t> choose_keyframes(const std::vector<KeyframeCandidate>& candidates,
                                                        const KeyframeConfig& config);

}  // namespace posefusion
