#include "hosts/io/sources/folder_poses.hpp"

#include <charconv>
#include <cstdint>
#include <limits>
#include <map>
#include <string>
#include <string_view>

#include "hosts/io/pose_matrix.hpp"
#include "hosts/io/sources/folder_camera.hpp"
#include "hosts/io/text_table.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

using Poses = std::map<std::uint64_t, Eigen::Isometry3d>;  ///< T_world_camera by the number of the frame

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

/// 12 of 12.txt, of frame-000012.pose.txt, of 0000012-000000366667.jpg.
std::optional<std::uint64_t> number_in(std::string_view name) {
    const std::size_t begin = name.find_first_of("0123456789");
    if (begin == std::string_view::npos) return std::nullopt;
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(name.data() + begin, name.data() + name.size(), number);
    if (error != std::errc{}) return std::nullopt;
    return number;
}

Poses read_replica_poses(const fs::path& file) {
    Poses poses;
    std::uint64_t frame = 0;
    for (const TextLine& line : read_text_table(file)) {
        std::vector<double> numbers;
        for (const std::string& field : line.fields)
            numbers.push_back(parse_number(field).value_or(std::numeric_limits<double>::quiet_NaN()));
        if (const auto pose = rigid_motion(numbers)) poses.emplace(frame, *pose);
        ++frame;
    }
    return poses;
}

Poses read_pose_files(const fs::path& folder, std::string_view ending) {
    Poses poses;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        const std::string name = entry.path().filename().string();
        const auto number = name.ends_with(ending) ? number_in(name) : std::nullopt;
        if (!number) continue;
        if (const auto pose = rigid_motion(read_numbers(entry.path()))) poses.emplace(*number, *pose);
    }
    return poses;
}

Trajectory of_frames(const Poses& poses, const std::vector<NumberedFrame>& frames) {
    Trajectory trajectory;
    for (const NumberedFrame& frame : frames) {
        const auto number = number_in(frame.color.filename().string());
        const auto pose = number ? poses.find(*number) : poses.end();
        if (pose != poses.end()) trajectory.push_back({frame.stamp, pose->second});
    }
    return trajectory;
}

Trajectory read_groundtruth(const fs::path& file, bool y_up) {
    Trajectory trajectory = read_trajectory(file);
    if (y_up) turn_y_down(trajectory);
    return trajectory;
}

}  // namespace

std::optional<Trajectory> folder_groundtruth(const fs::path& folder, const std::vector<NumberedFrame>& frames,
                                             bool y_up) {
    if (fs::exists(folder / "groundtruth.txt")) return read_groundtruth(folder / "groundtruth.txt", y_up);
    if (const auto icl = icl_groundtruth_file(folder)) return read_groundtruth(*icl, true);
    Poses poses;
    if (is_replica_folder(folder))
        poses = read_replica_poses(folder / "traj.txt");
    else if (fs::is_directory(folder / "pose"))
        poses = read_pose_files(folder / "pose", ".txt");
    else
        poses = read_pose_files(folder, ".pose.txt");
    Trajectory trajectory = of_frames(poses, frames);
    if (trajectory.empty()) return std::nullopt;
    return trajectory;
}

}  // namespace posefusion
