#pragma once
#include "hosts/io/frame_source.hpp"

namespace posefusion {

/// A folder with rgb.txt and depth.txt, paired within 20 ms by associate.py's rule, or associations.txt (which takes
/// precedence if it exists, unless options name another list), and the images they name. The camera comes from
/// options.camera_file, else camera.yaml in the folder, else what is known of the camera that the folder name tells.
///
/// ICL-NUIM is this layout, too: its lists name the depth image first, its camera is known, and its ground truth
/// (*.gt.freiburg beside the images) has y pointing up, which is turned into ours.
[[nodiscard]] std::unique_ptr<FrameSource> open_tum_folder(const std::filesystem::path& folder,
                                                           const SourceOptions& options);
/// Whether the folder has this layout.
[[nodiscard]] bool is_tum_folder(const std::filesystem::path& folder);

}  // namespace posefusion
