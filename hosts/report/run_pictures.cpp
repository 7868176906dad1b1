#include "hosts/report/run_pictures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "hosts/report/loop_picture.hpp"
#include "hosts/report/map_renderer.hpp"
#include "hosts/report/person_colors.hpp"
#include "hosts/report/plot.hpp"
#include "hosts/report/run_loops.hpp"
#include "hosts/report/run_objects.hpp"

namespace posefusion {
namespace {

constexpr Rgb8 kEstimate{31, 119, 180}, kTruth{120, 120, 120};

/// A camera with 55 degrees field of view across.
Intrinsics picture_camera(int width, int height) {
    const float f = static_cast<float>(width / 2.0 / std::tan(27.5 * std::numbers::pi / 180));
    return {f, f, static_cast<float>(width - 1) / 2, static_cast<float>(height - 1) / 2, width, height};
}

std::vector<Eigen::Vector2d> project(const std::vector<Eigen::Vector3d>& path, int x, int y) {
    std::vector<Eigen::Vector2d> points;
    for (const Eigen::Vector3d& p : path) points.emplace_back(p[x], p[y]);
    return points;
}

ColorImage plot_paths(const Paths& paths, const char* title, int x, int y, const char* x_label, const char* y_label) {
    std::vector<PlotLine> lines;
    if (!paths.groundtruth.empty()) lines.push_back({"ground truth", kTruth, project(paths.groundtruth, x, y)});
    lines.push_back({"estimate", kEstimate, project(paths.estimate, x, y)});
    for (const ObjectPath& object : paths.objects)
        lines.push_back(
            {std::to_string(object.label), label_color(object.label), project(object.positions, x, y), true});
    PlotConfig config;
    config.title = title;
    config.x_label = x_label;
    config.y_label = y_label;
    config.equal_axes = true;
    return draw_plot(lines, config);
}

/// Lost intervals and loops, in seconds.
std::vector<PlotSpan> marks_over_time(const ReportData& data) {
    constexpr Rgb8 kLost{250, 222, 208};
    const auto time = [&](std::size_t frame) {
        const std::size_t last = data.trajectory.size() - 1;
        return to_seconds(data.trajectory[std::min(frame, last)].stamp - data.trajectory.front().stamp);
    };
    std::vector<PlotSpan> spans;
    for (const LostInterval& lost : data.lost) spans.push_back({time(lost.first), time(lost.last), kLost});
    for (const LoopAttempt& attempt : loop_attempts(data)) {
        if (!attempt.event.accepted) continue;
        const double at = time(attempt.frame);
        spans.push_back(
            {at, at, attempt.event.kind == LoopKind::Relocalisation ? kLoopColors.relocalised : kLoopColors.loop});
    }
    return spans;
}

ColorImage plot_error(const ReportData& data) {
    const AbsoluteError& ate = data.evaluation->ate;
    const Stamp start = data.trajectory.front().stamp;
    constexpr double kCentimetres = 100;
    PlotLine line{"", {214, 39, 40}, {}};
    for (std::size_t i = 0; i < ate.stamps.size(); ++i)
        line.points.emplace_back(to_seconds(ate.stamps[i] - start), kCentimetres * ate.errors[i]);
    PlotConfig config;
    config.title = "Absolute trajectory error";
    config.x_label = "time (s)";
    config.y_label = "error (cm)";
    config.y_from_zero = true;
    config.spans = marks_over_time(data);
    return draw_plot({line}, config);
}

}  // namespace

Paths upright_paths(const ReportData& data, const Eigen::Isometry3d& upright) {
    Paths paths;
    if (data.trajectory.empty()) return paths;
    const Eigen::Isometry3d T_upright_world = upright.inverse();
    for (const StampedPose& pose : data.trajectory)
        paths.estimate.push_back(T_upright_world * pose.T_world_camera.translation());
    for (const ObjectOfRun& object : data.objects) {
        ObjectPath& path = paths.objects.emplace_back(ObjectPath{object.label, object_positions(data, object)});
        for (Eigen::Vector3d& position : path.positions) position = T_upright_world * position;
    }
    if (!data.groundtruth || !data.evaluation) return paths;
    const Eigen::Isometry3d T_upright_truth = T_upright_world * data.evaluation->ate.T_groundtruth_estimate.inverse();
    const Stamp first = data.trajectory.front().stamp - kMaxStampDifference;
    const Stamp last = data.trajectory.back().stamp + kMaxStampDifference;
    for (const StampedPose& pose : *data.groundtruth)
        if (pose.stamp >= first && pose.stamp <= last)
            paths.groundtruth.push_back(T_upright_truth * pose.T_world_camera.translation());
    return paths;
}

ColorImage trajectory_picture(const ReportData& data, const Paths& paths) {
    std::vector<ColorImage> pictures{plot_paths(paths, "Seen from above", 0, 1, "right (m)", "forward (m)"),
                                     plot_paths(paths, "Seen from the side", 1, 2, "forward (m)", "up (m)")};
    if (data.evaluation) pictures.push_back(plot_error(data));
    return beside(pictures);
}

ColorImage map_overview(const std::vector<Surfel>& map, const Eigen::Isometry3d& upright) {
    const Intrinsics camera = picture_camera(1200, 900);
    const double elevation = 50 * std::numbers::pi / 180;
    const Eigen::Vector3d forward = upright.linear().col(1), up = upright.linear().col(2);
    const Eigen::Vector3d direction = std::sin(elevation) * up - std::cos(elevation) * forward;
    return render_map(map, camera, overview_pose(map, camera, direction, up));
}

ColorImage map_from_start(const std::vector<Surfel>& map, const ReportData& data) {
    constexpr double kStepBack = 0.5;  // metres: the surroundings of the first image come into view
    Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
    if (!data.trajectory.empty()) pose = data.trajectory.front().T_world_camera;
    pose.translation() -= kStepBack * pose.linear().col(2);
    return render_map(map, picture_camera(1200, 900), pose);
}

}  // namespace posefusion
