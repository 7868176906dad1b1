#pragma once
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "hosts/io/frame_source.hpp"

/// Recordings of iPhones and iPads with LiDAR, as the app Stray Scanner writes them: rgb.mp4, depth/NUMBER.png
/// (millimetres, of 256x192 or so), confidence/NUMBER.png (0, 1 or 2 for each pixel of depth), camera_matrix.csv and
/// odometry.csv (stamp, number and pose of each image).
namespace posefusion {

/// A line of odometry.csv.
struct StrayFrame {
    std::string number;  ///< in the names of the files of depth and confidence; that of the image in the video
    StampedPose pose;    ///< by ARKit
};

/// Lines that cannot be read are left out, with a warning. Throws Error: no line can be read.
[[nodiscard]] std::vector<StrayFrame> read_stray_odometry(const std::filesystem::path& file,
                                                          std::vector<std::string>& warnings);
/// camera_matrix.csv: three rows of three. Throws Error. @param image  size of the images of the video
[[nodiscard]] Intrinsics read_stray_camera(const std::filesystem::path& file, ImageSize image);

[[nodiscard]] bool is_stray_folder(const std::filesystem::path& folder);

/// Depth is brought to the size of colour, without what has the lowest confidence. The ground truth is ARKit's
/// odometry. Throws Error: it cannot be used.
[[nodiscard]] std::unique_ptr<FrameSource> open_stray_folder(const std::filesystem::path& folder,
                                                             const SourceOptions& options);

}  // namespace posefusion
