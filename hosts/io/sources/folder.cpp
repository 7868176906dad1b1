#include "hosts/io/sources/folder.hpp"

#include <algorithm>

#include "hosts/io/known_cameras.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

/// The ground truth that ICL-NUIM gives beside the images, e.g. livingRoom0.gt.freiburg.
std::optional<fs::path> icl_groundtruth_file(const fs::path& folder) {
    std::vector<fs::path> found;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error))
        if (entry.path().filename().string().ends_with(".gt.freiburg")) found.push_back(entry.path());
    if (found.empty()) return std::nullopt;
    return *std::min_element(found.begin(), found.end());
}

/// ICL-NUIM's camera has fy = -480: its y axis points up, in camera and world. Mirroring both turns T into S T S with
/// S = diag(1, -1, 1), which is a rigid motion again.
void turn_y_down(Trajectory& trajectory) {
    const Eigen::DiagonalMatrix<double, 3> S(1, -1, 1);
    for (StampedPose& pose : trajectory) {
        const Eigen::Matrix3d R = S * pose.T_world_camera.linear() * S;
        pose.T_world_camera.linear() = R;
        pose.T_world_camera.translation().y() *= -1;
    }
}

}  // namespace

std::string folder_name(const fs::path& folder) {
    const fs::path full = fs::weakly_canonical(folder);
    return full.has_filename() ? full.filename().string() : full.parent_path().filename().string();
}

Camera folder_camera(const fs::path& folder, const SourceOptions& options) {
    if (!options.camera_file.empty()) return read_camera_file(options.camera_file);
    if (fs::exists(folder / "camera.yaml")) return read_camera_file(folder / "camera.yaml");
    if (const auto camera = known_camera(folder_name(folder))) return *camera;
    if (icl_groundtruth_file(folder)) return icl_camera();
    throw Error(folder.string() +
                ": the camera is not known: there is no camera.yaml and the folder name has no fr1, fr2, fr3 or icl; "
                "give one with --camera FILE (fx fy cx cy width height depth_scale)");
}

std::optional<Trajectory> folder_groundtruth(const fs::path& folder) {
    if (fs::exists(folder / "groundtruth.txt")) return read_trajectory(folder / "groundtruth.txt");
    const auto icl = icl_groundtruth_file(folder);
    if (!icl) return std::nullopt;
    Trajectory trajectory = read_trajectory(*icl);
    turn_y_down(trajectory);
    return trajectory;
}

ImageFiles::ImageFiles(const fs::path& folder, const SourceOptions& options, std::vector<FramePaths> frames,
                       std::vector<std::string> warnings)
    : folder_(folder) {
    facts_.location = folder.string();
    facts_.name = folder_name(folder);
    facts_.camera = folder_camera(folder, options);
    facts_.warnings = std::move(warnings);
    for (FramePaths& frame : frames) {
        facts_.frames.push_back(std::move(frame.entry));
        files_.push_back({std::move(frame.color), std::move(frame.depth)});
    }
}

RawFrame ImageFiles::read(std::size_t i) const {
    const FrameEntry& entry = facts_.frames.at(i);
    const Files& files = files_[i];
    const ImageSize size{facts_.camera.intrinsics.width, facts_.camera.intrinsics.height};
    return {entry.stamp,          entry.stamp_text,    read_color(files.color, size), read_raw_depth(files.depth, size),
            files.color.string(), files.depth.string()};
}

}  // namespace posefusion
