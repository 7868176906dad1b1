#pragma once
#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include "engine/core/error.hpp"
#include "hosts/io/frame_source.hpp"

/// What a folder of images says of its camera.
namespace posefusion {

enum class DepthCoding {
    Plain,
    MaybeRotated  ///< SUN3D: the bits of a value may be rotated to the left by three
};

struct FolderCamera {
    CameraDescription description;
    std::filesystem::path file;  ///< that says it; empty where it is known by the folder's name
    DepthCoding depth_coding = DepthCoding::Plain;
};

/// Last part of the full name of a folder.
[[nodiscard]] std::string folder_name(const std::filesystem::path& folder);

/// options.camera_file; else camera.yaml in the folder; else the file of a known layout: ScanNet's exports
/// (intrinsic/intrinsic_color.txt and its neighbours), Replica (cam_params.json, also above the folder), ETH3D and
/// ElasticFusion (calibration.txt), SUN3D (intrinsics.txt), 3DMatch (camera-intrinsics.txt), Open3D (intrinsic.json,
/// camera_intrinsic.json), ROS (camera_info.yaml); else the camera that the folder's name tells, ICL-NUIM's where its
/// ground truth is there, or Replica's where its trajectory is. Where the file does not say the depth unit it is that
/// of the layout. Throws Error: no camera, or one that cannot be used.
[[nodiscard]] FolderCamera find_folder_camera(const std::filesystem::path& folder, const SourceOptions& options);

/// Is it laid out as the Replica renderings of iMAP and NICE-SLAM: traj.txt and results/?
[[nodiscard]] bool is_replica_folder(const std::filesystem::path& folder);
/// Is it laid out as the exports of ScanNet: color/, depth/, pose/ and intrinsic/?
[[nodiscard]] bool is_scannet_folder(const std::filesystem::path& folder);
/// Is it laid out as SUN3D or Redwood: intrinsics.txt, or images named NUMBER-MICROSECONDS?
[[nodiscard]] bool is_sun3d_folder(const std::filesystem::path& folder);

/// The ground truth that ICL-NUIM gives beside the images, e.g. livingRoom0.gt.freiburg.
[[nodiscard]] std::optional<std::filesystem::path> icl_groundtruth_file(const std::filesystem::path& folder);

/// What `read` makes of the first of the files that it can read; one that it cannot is told when its frame comes.
template <class Read>
[[nodiscard]] auto first_readable(const std::vector<std::filesystem::path>& files, Read read)
    -> std::optional<std::invoke_result_t<Read, const std::filesystem::path&>> {
    constexpr std::size_t kTries = 30;
    for (std::size_t i = 0; i < std::min(files.size(), kTries); ++i) {
        try {
            return read(files[i]);
        } catch (const Error&) {
            continue;
        }
    }
    return std::nullopt;
}

}  // namespace posefusion
