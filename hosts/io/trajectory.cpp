#include "hosts/io/trajectory.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <ostream>

#include "engine/core/error.hpp"
#include "hosts/io/output_file.hpp"
#include "hosts/io/text_table.hpp"

namespace posefusion {
namespace {

constexpr std::size_t kFields = 8;

/// Below this length a quaternion says nothing about a rotation.
constexpr double kSmallestQuaternion = 1e-6;

std::string at_line(const std::filesystem::path& file, const TextLine& line) {
    return file.string() + ", line " + std::to_string(line.number) + ": ";
}

std::array<double, kFields> parse_fields(const std::filesystem::path& file, const TextLine& line) {
    if (line.fields.size() < kFields)
        throw Error(at_line(file, line) + "expected 8 numbers (stamp tx ty tz qx qy qz qw), found " +
                    std::to_string(line.fields.size()));
    std::array<double, kFields> values{};
    for (std::size_t i = 0; i < kFields; ++i) {
        const auto value = parse_number(line.fields[i]);
        if (!value) throw Error(at_line(file, line) + "'" + line.fields[i] + "' is not a number");
        values[i] = *value;
    }
    return values;
}

StampedPose to_pose(const std::filesystem::path& file, const TextLine& line, const std::array<double, kFields>& v) {
    Eigen::Quaterniond q(v[7], v[4], v[5], v[6]);
    if (q.norm() < kSmallestQuaternion) throw Error(at_line(file, line) + "the quaternion is zero");
    q.normalize();
    StampedPose pose;
    pose.stamp = v[0];
    pose.T_world_camera.linear() = q.toRotationMatrix();
    pose.T_world_camera.translation() = Eigen::Vector3d(v[1], v[2], v[3]);
    return pose;
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

}  // namespace

Trajectory read_trajectory(const std::filesystem::path& file) {
    Trajectory trajectory;
    for (const TextLine& line : read_text_table(file)) {
        const auto values = parse_fields(file, line);
        if (!std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); })) continue;
        trajectory.push_back(to_pose(file, line, values));
    }
    if (trajectory.empty()) throw Error(file.string() + ": holds no pose (expected lines: stamp tx ty tz qx qy qz qw)");

    std::stable_sort(trajectory.begin(), trajectory.end(),
                     [](const StampedPose& a, const StampedPose& b) { return a.stamp < b.stamp; });
    Trajectory unique;
    unique.reserve(trajectory.size());
    for (const StampedPose& pose : trajectory) {
        if (!unique.empty() && unique.back().stamp == pose.stamp)
            unique.back() = pose;
        else
            unique.push_back(pose);
    }
    return unique;
}

void write_trajectory(const std::filesystem::path& file, const Trajectory& trajectory) {
    constexpr double kResolution = 1e-9;
    write_file_atomically(file, [&](std::ostream& out) {
        out << "# timestamp tx ty tz qx qy qz qw (seconds, metres, camera to world)\n";
        std::array<char, 512> line{};
        for (const StampedPose& pose : trajectory) {
            const Eigen::Quaterniond q = canonical(pose.T_world_camera.linear());
            const Eigen::Vector3d& t = pose.T_world_camera.translation();
            std::array<double, 7> v{t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
            for (double& value : v) value = without_negative_zero(value, kResolution);
            const int length = std::snprintf(line.data(), line.size(), "%.6f %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n",
                                             pose.stamp, v[0], v[1], v[2], v[3], v[4], v[5], v[6]);
            if (length < 0 || static_cast<std::size_t>(length) >= line.size())
                throw Error(file.string() + ": a pose has numbers too large to write; the run has diverged");
            out.write(line.data(), length);
        }
    });
}

}  // namespace posefusion
