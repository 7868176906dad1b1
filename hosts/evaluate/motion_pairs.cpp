#include "hosts/evaluate/motion_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace posefusion {
namespace {

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

/// Tolerance of the motion of all pairs, relative to the delta.
constexpr double kTolerance = 0.1;

/// For each pose the value relative to the previous one; 0 for the first.
std::vector<double> steps(const Trajectory& trajectory, DeltaUnit unit) {
    std::vector<double> all(trajectory.size(), 0);
    for (std::size_t i = 1; i < trajectory.size(); ++i) {
        const Eigen::Isometry3d &from = trajectory[i - 1].T_world_camera, &to = trajectory[i].T_world_camera;
        all[i] = unit == DeltaUnit::Metres ? (to.translation() - from.translation()).norm()
                                           : angle_deg(from.linear().transpose() * to.linear());
    }
    return all;
}

/// By the sum of the rotations: the first pair begins at the first pose.
Pairs consecutive_pairs(const std::vector<double>& steps, double delta) {
    Pairs pairs;
    std::size_t start = 0;
    double sum = 0;
    for (std::size_t i = 1; i < steps.size(); ++i) {
        sum += steps[i];
        if (sum < delta) continue;
        pairs.emplace_back(start, i);
        start = i;
        sum = 0;
    }
    return pairs;
}

/// The way to where the first pair begins counts, too, but is none itself: so does evo.
Pairs consecutive_pairs_by_way(const std::vector<double>& steps, double delta) {
    Pairs pairs = consecutive_pairs(steps, delta);
    if (!pairs.empty()) pairs.erase(pairs.begin());
    return pairs;
}

Pairs pairs_by_frame(std::size_t frames, std::size_t delta, bool all) {
    Pairs pairs;
    for (std::size_t i = 0; i + delta < frames; i += all ? 1 : delta) pairs.emplace_back(i, i + delta);
    return pairs;
}

Pairs all_pairs_by_way(const Trajectory& trajectory, double delta) {
    std::vector<double> way = steps(trajectory, DeltaUnit::Metres);
    for (std::size_t i = 1; i < way.size(); ++i) way[i] += way[i - 1];
    Pairs pairs;
    for (std::size_t i = 0; i + 1 < way.size(); ++i) {
        // The path length never decreases: the nearest is one of the two around the point at distance delta; of equal
        // ones the first.
        const auto distance = [&](std::size_t j) { return std::abs(way[j] - way[i] - delta); };
        const auto rest = way.begin() + static_cast<std::ptrdiff_t>(i) + 1;
        auto j = static_cast<std::size_t>(
            std::lower_bound(rest, way.end(), delta, [&](double w, double d) { return w - way[i] < d; }) - way.begin());
        if (j == way.size() || (j > i + 1 && distance(j - 1) <= distance(j))) --j;
        while (j > i + 1 && distance(j - 1) == distance(j)) --j;
        if (distance(j) <= kTolerance * delta) pairs.emplace_back(i, j);
    }
    return pairs;
}

Pairs all_pairs_by_angle(const Trajectory& trajectory, double delta) {
    Pairs pairs;
    for (std::size_t i = 0; i < trajectory.size(); ++i) {
        const Eigen::Matrix3d R_camera_world = trajectory[i].T_world_camera.linear().transpose();
        for (std::size_t j = i + 1; j < trajectory.size(); ++j) {
            const double angle = angle_deg(R_camera_world * trajectory[j].T_world_camera.linear());
            if (std::abs(angle - delta) <= kTolerance * delta) pairs.emplace_back(i, j);
        }
    }
    return pairs;
}

}  // namespace

const char* name_of(DeltaUnit unit) {
    constexpr std::array<const char*, 4> kNames{"s", "frames", "m", "deg"};
    return kNames[static_cast<std::size_t>(unit)];
}

double angle_deg(const Eigen::Matrix3d& rotation) {
    return Eigen::AngleAxisd(rotation).angle() * 180.0 / std::numbers::pi;
}

Pairs motion_pairs(const Trajectory& trajectory, DeltaUnit unit, double delta, bool all) {
    if (unit == DeltaUnit::Frames) return pairs_by_frame(trajectory.size(), static_cast<std::size_t>(delta), all);
    if (unit == DeltaUnit::Metres)
        return all ? all_pairs_by_way(trajectory, delta) : consecutive_pairs_by_way(steps(trajectory, unit), delta);
    return all ? all_pairs_by_angle(trajectory, delta) : consecutive_pairs(steps(trajectory, unit), delta);
}

}  // namespace posefusion
