#include "hosts/io/sources/folder_poses.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>
#include <vector>

#include "hosts/io/pose_matrix.hpp"
#include "hosts/io/sources/folder_camera.hpp"
#include "hosts/io/text_table.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

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

/// As image_folder_source.cpp has it for images that are only numbered.
double stamp_of_number(std::size_t number) {
    constexpr double kFramesPerSecond = 30;
    char text[64];
    std::snprintf(text, sizeof text, "%.6f", static_cast<double>(number) / kFramesPerSecond);
    return parse_number(text).value_or(0);
}

/// Replica: line i is frame i.
Trajectory read_replica_poses(const fs::path& file) {
    Trajectory trajectory;
    std::size_t frame = 0;
    for (const TextLine& line : read_text_table(file)) {
        std::vector<double> numbers;
        for (const std::string& field : line.fields) numbers.push_back(parse_number(field).value_or(NAN));
        if (const auto pose = rigid_motion(numbers)) trajectory.push_back({stamp_of_number(frame), *pose});
        ++frame;
    }
    return trajectory;
}

/// "12" of 12.txt, of frame-000012.pose.txt.
std::optional<std::size_t> number_in(std::string_view name) {
    const std::size_t begin = name.find_first_of("0123456789");
    if (begin == std::string_view::npos) return std::nullopt;
    std::uint32_t number = 0;
    const auto [end, error] = std::from_chars(name.data() + begin, name.data() + name.size(), number);
    if (error != std::errc{}) return std::nullopt;
    return number;
}

/// A file per frame.
Trajectory read_pose_files(const fs::path& folder, std::string_view ending) {
    std::vector<std::pair<std::size_t, fs::path>> files;
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
        const std::string name = entry.path().filename().string();
        if (const auto number = name.ends_with(ending) ? number_in(name) : std::nullopt)
            files.emplace_back(*number, entry.path());
    }
    std::sort(files.begin(), files.end());
    Trajectory trajectory;
    for (const auto& [number, file] : files) {
        const double stamp = stamp_of_number(number);
        const auto pose = rigid_motion(read_numbers(file));
        if (pose && (trajectory.empty() || trajectory.back().stamp < stamp)) trajectory.push_back({stamp, *pose});
    }
    return trajectory;
}

}  // namespace

std::optional<Trajectory> folder_groundtruth(const fs::path& folder, bool y_up) {
    Trajectory trajectory;
    const auto icl = icl_groundtruth_file(folder);
    if (const fs::path own = folder / "groundtruth.txt"; fs::exists(own)) {
        trajectory = read_trajectory(own);
        if (y_up) turn_y_down(trajectory);
    } else if (icl) {
        trajectory = read_trajectory(*icl);
        turn_y_down(trajectory);
    } else if (is_replica_folder(folder)) {
        trajectory = read_replica_poses(folder / "traj.txt");
    } else if (fs::is_directory(folder / "pose")) {
        trajectory = read_pose_files(folder / "pose", ".txt");
    } else {
        trajectory = read_pose_files(folder, ".pose.txt");
    }
    if (trajectory.empty()) return std::nullopt;
    return trajectory;
}

}  // namespace posefusion
