#include "hosts/io/sources/folder_camera.hpp"

#include <regex>

#include "hosts/io/known_cameras.hpp"
#include "hosts/io/pose_matrix.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr float kMillimetres = 1000.0f, kTumUnits = 5000.0f;

/// A file in which a data set or a program keeps the camera, and the unit of its depth images.
struct CameraPlace {
    const char* file;
    float depth_scale;
};
constexpr const char* kSun3dFile = "intrinsics.txt";
constexpr const char* kReplicaFile = "cam_params.json";
constexpr CameraPlace kPlaces[] = {{"camera.yaml", kTumUnits},        {"camera.yml", kTumUnits},
                                   {kReplicaFile, kMillimetres},      {"calibration.txt", kTumUnits},
                                   {kSun3dFile, kMillimetres},        {"camera-intrinsics.txt", kMillimetres},
                                   {"intrinsic.json", kMillimetres},  {"camera_intrinsic.json", kMillimetres},
                                   {"camera_info.yaml", kMillimetres}};
constexpr const char *kScanNetFolder = "intrinsic", *kScanNetColor = "intrinsic_color.txt";

FolderCamera read_place(const fs::path& file, float depth_scale) {
    FolderCamera found;
    found.description = read_camera_description(file);
    found.file = file;
    if (!found.description.says_depth_scale) found.description.camera.depth_scale = depth_scale;
    return found;
}

/// intrinsic/ of a ScanNet export: colour and depth are of two cameras, in images of two sizes.
FolderCamera read_scannet(const fs::path& folder) {
    FolderCamera found = read_place(folder / kScanNetColor, kMillimetres);
    if (!fs::exists(folder / "intrinsic_depth.txt")) return found;
    const CameraDescription depth = read_camera_description(folder / "intrinsic_depth.txt");
    found.description.depth = {depth.camera.intrinsics, {}, Eigen::Isometry3f::Identity()};
    const fs::path color_file = folder / "extrinsic_color.txt", depth_file = folder / "extrinsic_depth.txt";
    if (fs::exists(color_file) && fs::exists(depth_file))
        found.description.depth->T_color_depth =
            (read_rigid_motion(color_file).inverse() * read_rigid_motion(depth_file)).cast<float>();
    return found;
}

std::optional<FolderCamera> camera_in(const fs::path& folder) {
    for (const CameraPlace& place : kPlaces)
        if (fs::exists(folder / place.file)) return read_place(folder / place.file, place.depth_scale);
    if (fs::exists(folder / kScanNetFolder / kScanNetColor)) return read_scannet(folder / kScanNetFolder);
    const fs::path above = fs::weakly_canonical(folder).parent_path() / kReplicaFile;
    if (is_replica_folder(folder) && fs::exists(above)) return read_place(above, replica_camera().depth_scale);
    return std::nullopt;
}

/// Of folders that hold no camera file.
std::optional<Camera> camera_by_layout(const fs::path& folder) {
    if (const auto known = known_camera(folder_name(folder))) return known;
    if (icl_groundtruth_file(folder)) return icl_camera();
    if (is_replica_folder(folder)) return replica_camera();
    return std::nullopt;
}

/// Where the given camera file does not say it.
float depth_scale_of(const fs::path& folder) {
    if (const auto known = camera_by_layout(folder)) return known->depth_scale;
    return is_scannet_folder(folder) || is_sun3d_folder(folder) ? kMillimetres : kTumUnits;
}

FolderCamera find_camera(const fs::path& folder, const SourceOptions& options) {
    if (!options.camera_file.empty()) return read_place(options.camera_file, depth_scale_of(folder));
    if (auto found = camera_in(folder)) return *std::move(found);
    const auto known = camera_by_layout(folder);
    if (!known)
        throw Error(
            folder.string() +
            ": the camera is not known: there is no camera.yaml (nor the camera file of another layout) and the "
            "folder name has no fr1, fr2, fr3, icl or rgbd_bonn; give one with --camera FILE (fx fy cx cy width "
            "height depth_scale)");
    FolderCamera found;
    found.description.camera = *known;
    return found;
}

}  // namespace

std::string folder_name(const fs::path& folder) {
    const fs::path full = fs::weakly_canonical(folder);
    return full.has_filename() ? full.filename().string() : full.parent_path().filename().string();
}

std::optional<fs::path> icl_groundtruth_file(const fs::path& folder) {
    std::vector<fs::path> found;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error))
        if (entry.path().filename().string().ends_with(".gt.freiburg")) found.push_back(entry.path());
    if (found.empty()) return std::nullopt;
    return *std::min_element(found.begin(), found.end());
}

bool is_replica_folder(const fs::path& folder) {
    return fs::exists(folder / "traj.txt") && fs::is_directory(folder / "results");
}

bool is_scannet_folder(const fs::path& folder) {
    return fs::is_directory(folder / kScanNetFolder) && fs::is_directory(folder / "pose");
}

bool is_sun3d_folder(const fs::path& folder) {
    if (fs::exists(folder / kSun3dFile)) return true;
    const std::regex numbered_twice("\\d+-\\d+");
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder / "depth", error))
        if (has_image_ending(entry.path())) return std::regex_match(entry.path().stem().string(), numbered_twice);
    return false;
}

FolderCamera find_folder_camera(const fs::path& folder, const SourceOptions& options) {
    FolderCamera found = find_camera(folder, options);
    if (is_sun3d_folder(folder)) found.depth_coding = DepthCoding::MaybeRotated;
    return found;
}

}  // namespace posefusion
