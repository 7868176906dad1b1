#pragma once
#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "pose/joints.hpp"

/// Just enough of a TUM folder for this program: pairs, poses, true masks and true joints where they exist.
namespace posefusion::mask_accuracy {

struct Entry {
    std::string stamp;  ///< of the colour image
    std::filesystem::path color, depth;
    std::filesystem::path mask;                                        ///< empty = no truth
    Eigen::Isometry3f T_world_camera = Eigen::Isometry3f::Identity();  ///< identity without groundtruth.txt
};

struct Sequence {
    Intrinsics camera;
    float depth_scale = 5000;  ///< units of the depth images per metre
    std::vector<Entry> frames;
    std::vector<People> joints;  ///< true joints per frame (joints.json); empty without
};

[[nodiscard]] Sequence open_sequence(const std::filesystem::path& folder);
[[nodiscard]] ColorImage read_color(const std::filesystem::path& file);
[[nodiscard]] DepthImage read_depth(const std::filesystem::path& file, float depth_scale);
[[nodiscard]] LabelImage read_mask(const std::filesystem::path& file);

}  // namespace posefusion::mask_accuracy
