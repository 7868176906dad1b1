#include "hosts/report/run_objects.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "engine/core/number_text.hpp"
#include "hosts/report/person_colors.hpp"

namespace posefusion {
namespace {

/// "12 (0.40 s)", the frame of a stamp.
std::string frame_at(const ReportData& data, Stamp stamp) {
    const auto at = std::lower_bound(data.trajectory.begin(), data.trajectory.end(), stamp,
                                     [](const StampedPose& pose, Stamp wanted) { return pose.stamp < wanted; });
    return std::to_string(at - data.trajectory.begin()) + " (" +
           fixed_text(to_seconds(stamp - data.trajectory.front().stamp), 2) + " s)";
}

std::string object_row(const ReportData& data, const ObjectOfRun& object) {
    const auto cell = [](const std::string& text) { return "<td class=\"number\">" + text + "</td>"; };
    return "<tr><td><i class=\"swatch\" style=\"background: " + css_color(label_color(object.label)) + "\"></i>" +
           std::to_string(object.label) + "</td>" + cell(std::to_string(object.trajectory.size())) +
           cell(frame_at(data, object.trajectory.front().stamp)) +
           cell(frame_at(data, object.trajectory.back().stamp)) + cell(fixed_text(path_length(object.trajectory), 2)) +
           cell(std::to_string(object.stable_surfels)) + "</tr>\n";
}

}  // namespace

std::vector<Eigen::Vector3d> object_positions(const ReportData& data, const ObjectOfRun& object) {
    std::vector<Eigen::Vector3d> positions;
    auto pose = object.trajectory.begin();
    bool interrupted = false;
    for (const StampedPose& frame : data.trajectory) {
        if (pose == object.trajectory.end()) break;
        if (pose->stamp != frame.stamp) {
            interrupted = !positions.empty();
            continue;
        }
        if (std::exchange(interrupted, false))
            positions.emplace_back(Eigen::Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
        positions.emplace_back(pose->T_world_camera.translation());
        ++pose;
    }
    return positions;
}

double path_length(const Trajectory& trajectory) {
    double length = 0;
    const StampedPose* last = nullptr;
    for (const StampedPose& pose : trajectory) {
        const double step =
            last == nullptr ? 0 : (pose.T_world_camera.translation() - last->T_world_camera.translation()).norm();
        if (last != nullptr && step < kPathJitter) continue;
        length += step;
        last = &pose;
    }
    return length;
}

std::string css_color(Rgb8 color) {
    return "rgb(" + std::to_string(color.r) + ", " + std::to_string(color.g) + ", " + std::to_string(color.b) + ")";
}

std::string objects_html(const ReportData& data) {
    if (data.objects.empty()) return {};
    std::string html =
        "<section>\n<h2>Objects</h2>\n<p>What moved as a rigid body, by its label in the masks. The plots above show "
        "the paths.</p>\n<table><tr><th>label</th>";
    for (const char* column : {"frames tracked", "first frame", "last frame", "path m", "stable surfels"})
        html += std::string("<th class=\"number\">") + column + "</th>";
    html += "</tr>\n";
    for (const ObjectOfRun& object : data.objects) html += object_row(data, object);
    return html + "</table>\n</section>\n";
}

}  // namespace posefusion
