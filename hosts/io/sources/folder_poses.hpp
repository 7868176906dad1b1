#pragma once
#include <filesystem>
#include <optional>
#include <vector>

#include "hosts/io/trajectory.hpp"

/// The true poses that lie in a folder of images.
namespace posefusion {

/// A frame to which a matrix may belong.
struct NumberedFrame {
    Stamp stamp{};
    std::filesystem::path color;  ///< the first number in its name is that of the frame
};

/// groundtruth.txt (TUM, Bonn, ETH3D); else the *.gt.freiburg of an ICL-NUIM recording; else traj.txt of Replica (line
/// i is frame i), or a 4x4 matrix per frame: pose/NUMBER.txt (ScanNet), frame-NUMBER.pose.txt (7-Scenes). Matrices
/// belong to the frames whose images have their numbers; those of frames where the camera was lost are left out.
/// nullopt where there is none of these. Throws Error for a list of poses that cannot be read.
/// @param frames  with ascending stamps
/// @param y_up    y points up in the camera that belongs to groundtruth.txt (as in ICL-NUIM's); it is turned to ours
[[nodiscard]] std::optional<Trajectory> folder_groundtruth(const std::filesystem::path& folder,
                                                           const std::vector<NumberedFrame>& frames, bool y_up);

}  // namespace posefusion
