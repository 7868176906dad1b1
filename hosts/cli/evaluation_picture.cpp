#include "hosts/cli/evaluation_picture.hpp"

#include <algorithm>
#include <array>

#include "hosts/report/plot.hpp"

namespace posefusion {
namespace {

constexpr Rgb8 kEstimate{31, 119, 180}, kTruth{120, 120, 120}, kError{214, 39, 40};
using Path = std::vector<Eigen::Vector3d>;

Path aligned_path(const Trajectory& estimate, const AbsoluteError& ate) {
    Path path;
    for (const StampedPose& pose : estimate)
        path.push_back(ate.T_groundtruth_estimate * (ate.scale * pose.T_world_camera.translation()));
    return path;
}

/// The part of the trajectory during the estimate.
Path true_path(const Trajectory& groundtruth, const Trajectory& estimate, Stamp margin) {
    Path path;
    for (const StampedPose& pose : groundtruth)
        if (pose.stamp >= estimate.front().stamp - margin && pose.stamp <= estimate.back().stamp + margin)
            path.push_back(pose.T_world_camera.translation());
    return path;
}

/// x, y and z, sorted by the extent of the path along them.
std::array<int, 3> axes_by_extent(const Path& path) {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : path) box.extend(p);
    std::array<int, 3> axes{0, 1, 2};
    std::stable_sort(axes.begin(), axes.end(), [&](int a, int b) { return box.sizes()[a] > box.sizes()[b]; });
    return axes;
}

ColorImage plot_paths(const Path& truth, const Path& model, int right, int up) {
    const auto project = [&](const Path& path) {
        std::vector<Eigen::Vector2d> points;
        for (const Eigen::Vector3d& p : path) points.emplace_back(p[right], p[up]);
        return points;
    };
    const auto label = [](int axis) { return std::string(1, static_cast<char>('x' + axis)) + " (m)"; };
    PlotConfig config;
    config.title = "Trajectory";
    config.x_label = label(right);
    config.y_label = label(up);
    config.equal_axes = true;
    return draw_plot({{"ground truth", kTruth, project(truth)}, {"estimate", kEstimate, project(model)}}, config);
}

ColorImage plot_error(const Evaluation& evaluation) {
    constexpr double kCentimetres = 100;
    const AbsoluteError& ate = evaluation.ate;
    PlotLine line{"", kError, {}};
    for (std::size_t i = 0; i < ate.stamps.size(); ++i) {
        const double time = to_seconds(ate.stamps[i] - ate.stamps.front());
        line.points.emplace_back(evaluation.duration ? time : static_cast<double>(i), kCentimetres * ate.errors[i]);
    }
    PlotConfig config;
    config.title = "Absolute trajectory error";
    config.x_label = evaluation.duration ? "time (s)" : "pose";
    config.y_label = "error (cm)";
    config.y_from_zero = true;
    return draw_plot({line}, config);
}

}  // namespace

ColorImage evaluation_picture(const Trajectory& groundtruth, const Trajectory& estimate, const Evaluation& evaluation) {
    const Path truth = true_path(groundtruth, estimate, evaluation.config.matching.max_difference);
    const Path model = aligned_path(estimate, evaluation.ate);
    const auto [a, b, c] = axes_by_extent(truth);
    // The alphabetically first axis points to the right.
    return beside({plot_paths(truth, model, std::min(a, b), std::max(a, b)),
                   plot_paths(truth, model, std::min(a, c), std::max(a, c)), plot_error(evaluation)});
}

}  // namespace posefusion
