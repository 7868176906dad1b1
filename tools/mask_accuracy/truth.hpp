#pragma once
#include <Eigen/Geometry>
#include <filesystem>
#include <vector>

#include "engine/core/image.hpp"
#include "hosts/io/recording.hpp"
#include "pose/joints.hpp"

namespace posefusion::mask_accuracy {

/// What is known of the frames of a recording besides their images.
struct Truth {
    std::vector<Eigen::Isometry3f> T_world_camera;  ///< per frame; identity where groundtruth.txt says nothing
    std::vector<People> joints;                     ///< per frame, of joints.json; empty without
    std::filesystem::path masks;                    ///< folder of label images by time stamp
};

/// Throws Error for files that are there but cannot be used.
[[nodiscard]] Truth read_truth(const Recording& recording);
/// In the geometry of the recording's images; empty = there is none.
[[nodiscard]] LabelImage true_mask(const Truth& truth, const Recording& recording, const Frame& frame);

}  // namespace posefusion::mask_accuracy
