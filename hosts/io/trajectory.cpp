#include "hosts/io/trajectory.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <ostream>
#include <string_view>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/io/output_file.hpp"
#include "hosts/io/pose_matrix.hpp"
#include "hosts/io/text_table.hpp"

namespace posefusion {
namespace {

constexpr std::size_t kPoseColumns = 8, kStateColumns = 17, kKittiColumns = 12, kMatrixColumns = 16;
/// A quaternion whose norm deviates more from 1 indicates another format; files have at least three decimals.
constexpr double kQuaternionTolerance = 0.1;
constexpr double kFarthest = 1e9;  ///< metres: errors stay finite

std::string at_line(const std::filesystem::path& file, const TextLine& line) {
    return file.string() + ", line " + std::to_string(line.number) + ": ";
}

/// Numbers of a line; words after the last are dropped.
std::size_t columns_of(const TextLine& line) {
    std::size_t columns = line.fields.size();
    while (columns > 0 && !parse_number(line.fields[columns - 1])) --columns;
    return columns;
}

/// Does a header name w before x? nullopt: it names no quaternion.
std::optional<bool> names_w_first(const std::vector<TextLine>& headers) {
    for (const TextLine& header : headers) {
        std::optional<std::size_t> w, x;
        for (std::size_t i = 0; i < header.fields.size(); ++i) {
            std::string_view name = header.fields[i];  // q_RS_w, qw, q_w[]
            if (name.starts_with('#')) name.remove_prefix(1);
            name = name.substr(0, name.find('['));
            if (name.empty() || std::tolower(static_cast<unsigned char>(name.front())) != 'q') continue;
            const int last = std::tolower(static_cast<unsigned char>(name.back()));
            if (last == 'w') w = i;
            if (last == 'x') x = i;
        }
        if (w && x) return *w < *x;
    }
    return std::nullopt;
}

/// The content of the file, before its format is known.
struct Table {
    std::filesystem::path file;
    std::vector<TextLine> headers;  ///< comments, and lines before the first that begins with a number
    std::vector<TextLine> lines;
    std::size_t columns = 0;

    [[nodiscard]] bool has_stamps() const { return columns == kPoseColumns || columns == kStateColumns; }
};

Table read_table(const std::filesystem::path& file) {
    Table table{file, {}, {}};
    bool begun = false;
    for (TextLine& line : read_text_table(file, Comments::Keep)) {
        const std::string& first = line.fields.front();
        const bool comment = first.front() == '#';
        begun = begun || (!comment && parse_number(first));
        const bool named =
            !comment && !begun && table.headers.empty() && std::isalpha(static_cast<unsigned char>(first.front())) != 0;
        if (comment || named)
            table.headers.push_back(std::move(line));
        else
            table.lines.push_back(std::move(line));
    }
    if (table.lines.empty())
        throw Error(file.string() + ": holds no pose (expected lines: stamp tx ty tz qx qy qz qw)");
    const TextLine& first = table.lines.front();
    table.columns = columns_of(first);
    for (const std::size_t known : {kPoseColumns, kStateColumns, kKittiColumns, kMatrixColumns})
        if (table.columns == known) return table;
    throw Error(at_line(file, first) + std::to_string(table.columns) +
                " numbers are no pose: expected 8 (TUM: stamp tx ty tz qx qy qz qw; ASL: stamp tx ty tz qw qx qy qz), "
                "17 (EuRoC), 12 (KITTI) or 16 (matrices)");
}

TrajectoryFormat format_of(const Table& table, std::optional<TimeUnit> unit) {
    if (table.columns == kKittiColumns) return TrajectoryFormat::Kitti;
    if (table.columns == kMatrixColumns) return TrajectoryFormat::Matrices;
    if (const auto w_first = names_w_first(table.headers))
        return *w_first ? TrajectoryFormat::Asl : TrajectoryFormat::Tum;
    const bool asl = table.columns == kStateColumns || (table.lines.front().commas && unit == TimeUnit::Nanoseconds);
    return asl ? TrajectoryFormat::Asl : TrajectoryFormat::Tum;
}

std::vector<double> numbers_of(const Table& table, const TextLine& line) {
    for (std::size_t i = 0; i < std::min(table.columns, line.fields.size()); ++i)
        if (!parse_number(line.fields[i]))
            throw Error(at_line(table.file, line) + "'" + line.fields[i] + "' is not a number");
    if (columns_of(line) != table.columns)
        throw Error(at_line(table.file, line) + "expected " + std::to_string(table.columns) + " numbers as in line " +
                    std::to_string(table.lines.front().number) + ", found " + std::to_string(columns_of(line)));
    std::vector<double> numbers;
    for (std::size_t i = 0; i < table.columns; ++i) numbers.push_back(*parse_number(line.fields[i]));
    return numbers;
}

void check_position(const Table& table, const TextLine& line, const Eigen::Isometry3d& pose) {
    if (!(pose.translation().cwiseAbs().maxCoeff() <= kFarthest))
        throw Error(at_line(table.file, line) + "its position is more than " + shortest_text(kFarthest) +
                    " m from the origin; is the file damaged?");
}

/// @param v  numbers of a line, the stamp first
Eigen::Isometry3d stamped_pose(const Table& table, const TextLine& line, bool w_first, const std::vector<double>& v) {
    Eigen::Quaterniond q =
        w_first ? Eigen::Quaterniond(v[4], v[5], v[6], v[7]) : Eigen::Quaterniond(v[7], v[4], v[5], v[6]);
    if (std::abs(q.norm() - 1) > kQuaternionTolerance)
        throw Error(at_line(table.file, line) +
                    "columns 5 to 8 are no quaternion of length 1 (expected stamp tx ty tz " +
                    (w_first ? "qw qx qy qz)" : "qx qy qz qw)"));
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    pose.linear() = q.normalized().toRotationMatrix();
    pose.translation() = Eigen::Vector3d(v[1], v[2], v[3]);
    check_position(table, line, pose);
    return pose;
}

/// @param v  12 or 16 numbers, row by row
Eigen::Isometry3d matrix_pose(const Table& table, const TextLine& line, const std::vector<double>& v) {
    const auto pose = rigid_motion(v);
    if (!pose)
        throw Error(at_line(table.file, line) + "its " + std::to_string(v.size()) +
                    " numbers are not the rows of a rigid motion (r11 r12 r13 tx r21 ... tz" +
                    (v.size() == kKittiColumns ? ")" : " 0 0 0 1)"));
    check_position(table, line, *pose);
    return *pose;
}

/// Sorts by stamp and keeps the last of equal ones; corrections are added to the warnings.
void put_in_order(Trajectory& poses, const std::filesystem::path& file, std::vector<std::string>& warnings) {
    const auto earlier = [](const StampedPose& a, const StampedPose& b) { return a.stamp < b.stamp; };
    if (!std::is_sorted(poses.begin(), poses.end(), earlier)) {
        warnings.push_back(file.string() + ": time stamps are not in order; they have been sorted");
        std::stable_sort(poses.begin(), poses.end(), earlier);
    }
    Trajectory unique;
    unique.reserve(poses.size());
    for (const StampedPose& pose : poses) {
        if (!unique.empty() && unique.back().stamp == pose.stamp)
            unique.back() = pose;
        else
            unique.push_back(pose);
    }
    if (unique.size() < poses.size())
        warnings.push_back(file.string() + ": " + std::to_string(poses.size() - unique.size()) +
                           " of its time stamps were there before; the last pose of each counts");
    poses = std::move(unique);
}

/// A stable choice between q and -q: the first of w, x, y, z that is not zero is positive.
Eigen::Quaterniond canonical(const Eigen::Matrix3d& rotation) {
    Eigen::Quaterniond q(rotation);
    q.normalize();
    for (const double value : {q.w(), q.x(), q.y(), q.z()}) {
        if (value == 0) continue;
        if (value < 0) q.coeffs() = -q.coeffs();
        break;
    }
    return q;
}

/// -0.000 and 0.000 are the same number and must be the same bytes.
double without_negative_zero(double value, double resolution) { return std::abs(value) < resolution / 2 ? 0.0 : value; }

/// The first line of a file; empty: the format has none.
const char* title_of(TrajectoryFormat format) {
    if (format == TrajectoryFormat::Tum) return "# timestamp tx ty tz qx qy qz qw (seconds, metres, camera to world)\n";
    if (format == TrajectoryFormat::Asl)
        return "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n";
    return "";
}

/// What follows the stamp: position and quaternion, or the rows of the matrix.
std::vector<double> numbers_of(const Eigen::Isometry3d& pose, TrajectoryFormat format) {
    const Eigen::Vector3d& t = pose.translation();
    const Eigen::Quaterniond q = canonical(pose.linear());
    if (format == TrajectoryFormat::Tum) return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
    if (format == TrajectoryFormat::Asl) return {t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z()};
    std::vector<double> numbers;
    for (Eigen::Index row = 0; row < (format == TrajectoryFormat::Kitti ? 3 : 4); ++row)
        for (Eigen::Index column = 0; column < 4; ++column) numbers.push_back(pose.matrix()(row, column));
    return numbers;
}

std::string line_of(const StampedPose& pose, TrajectoryFormat format, const std::filesystem::path& file) {
    constexpr int kDecimals = 9;
    constexpr double kResolution = 1e-9, kLargest = 1e15;
    const char separator = format == TrajectoryFormat::Asl ? ',' : ' ';
    std::string line;
    if (format == TrajectoryFormat::Tum) line = seconds_text(pose.stamp);
    if (format == TrajectoryFormat::Asl) line = shortest_text(pose.stamp.count());
    for (const double value : numbers_of(pose.T_world_camera, format)) {
        if (!(std::abs(value) < kLargest))
            throw Error(file.string() + ": a pose has numbers too large to write; the run has diverged");
        if (!line.empty()) line += separator;
        line += fixed_text(without_negative_zero(value, kResolution), kDecimals);
    }
    return line;
}

}  // namespace

const char* name_of(TrajectoryFormat format) {
    constexpr std::array<const char*, 4> kNames{"TUM", "ASL / EuRoC", "KITTI", "matrices"};
    return kNames[static_cast<std::size_t>(format)];
}

std::string TrajectoryFile::description() const {
    return name_of(format) + (unit ? std::string(", stamps in ") + symbol_of(*unit) : ", without stamps");
}

TrajectoryFile read_trajectory_file(const std::filesystem::path& file, std::optional<TimeUnit> given) {
    const Table table = read_table(file);
    TrajectoryFile result;
    if (table.has_stamps()) {
        std::vector<std::string_view> stamps;
        for (const TextLine& line : table.lines) stamps.push_back(line.fields.front());
        result.unit = recognise_time_unit(stamps, given, file.string());
    }
    result.format = format_of(table, result.unit);
    result.rows = table.lines.size();
    std::size_t lost = 0;
    for (std::size_t i = 0; i < table.lines.size(); ++i) {
        const TextLine& line = table.lines[i];
        const std::vector<double> numbers = numbers_of(table, line);
        if (!std::all_of(numbers.begin(), numbers.end(), [](double v) { return std::isfinite(v); })) {
            ++lost;
            continue;
        }
        StampedPose pose;
        if (result.unit) {
            const auto stamp = parse_stamp(line.fields.front(), *result.unit);
            if (!stamp) throw Error(at_line(file, line) + "'" + line.fields.front() + "' is no time");
            pose.stamp = *stamp;
            pose.T_world_camera = stamped_pose(table, line, result.format == TrajectoryFormat::Asl, numbers);
        } else {
            pose.stamp = std::chrono::seconds(i);
            pose.T_world_camera = matrix_pose(table, line, numbers);
        }
        result.poses.push_back(pose);
    }
    if (result.poses.empty())
        throw Error(file.string() + ": holds no pose, only lines with numbers that are not finite");
    if (lost > 0)
        result.warnings.push_back(file.string() + ": " + std::to_string(lost) + " of " +
                                  std::to_string(table.lines.size()) +
                                  " poses are not finite (camera lost) and left out");
    put_in_order(result.poses, file, result.warnings);
    return result;
}

Trajectory read_trajectory(const std::filesystem::path& file) {
    TrajectoryFile trajectory = read_trajectory_file(file);
    if (!trajectory.unit)
        throw Error(file.string() + ": is a trajectory without time stamps (" + name_of(trajectory.format) +
                    "); expected lines: stamp tx ty tz qx qy qz qw");
    return std::move(trajectory.poses);
}

void write_trajectory(const std::filesystem::path& file, const Trajectory& trajectory, TrajectoryFormat format) {
    write_file_atomically(file, [&](std::ostream& out) {
        out << title_of(format);
        for (const StampedPose& pose : trajectory) out << line_of(pose, format, file) << '\n';
    });
}

}  // namespace posefusion
