#include "hosts/report/run_loops.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "engine/core/number_text.hpp"
#include "hosts/report/html.hpp"

namespace posefusion {
namespace {

constexpr std::size_t kLongTable = 8;  ///< rows from which on a table is folded
constexpr const char* kNothing = "\xE2\x80\x93";

/// Camera of one of the engine's frames, which count on from those of a loaded map.
std::optional<Eigen::Vector3d> camera_position(const ReportData& data, std::size_t engine_frame) {
    const std::size_t earlier = data.earlier_poses.size();
    if (engine_frame < earlier) return data.earlier_poses[engine_frame].translation();
    if (engine_frame - earlier >= data.trajectory.size()) return std::nullopt;
    return data.trajectory[engine_frame - earlier].T_world_camera.translation();
}

std::optional<Eigen::Vector3d> camera_of_run(const ReportData& data, std::size_t frame) {
    return camera_position(data, data.earlier_poses.size() + frame);
}

std::string counted(std::size_t number, const char* one, const char* many) {
    return std::to_string(number) + " " + (number == 1 ? one : many);
}

/// "12 (0.40 s)"
std::string when(const ReportData& data, std::size_t frame) {
    std::string text = std::to_string(frame);
    if (frame < data.trajectory.size())
        text += " (" + fixed_text(to_seconds(data.trajectory[frame].stamp - data.trajectory.front().stamp), 2) + " s)";
    return text;
}

/// The frame in which the older part of the map was seen. A lost camera is first searched for at its last pose.
std::string model_frame(const ReportData& data, const LoopEvent& event) {
    if (event.model_frame == event.frame) return kNothing;
    const std::size_t earlier = data.earlier_poses.size(), engine_frame = event.model_frame;
    return engine_frame < earlier ? std::to_string(engine_frame) + " of the loaded map"
                                  : std::to_string(engine_frame - earlier);
}

std::string number_cell(const std::string& text) { return "<td class=\"number\">" + text + "</td>"; }
/// A value of exactly 0 was not measured: the attempt ended before.
std::string measured_cell(int decimals, double value) {
    return number_cell(value == 0 ? kNothing : fixed_text(value, decimals));
}

std::string attempt_row(const ReportData& data, const LoopAttempt& attempt) {
    constexpr double kMillimetres = 1000, kPercent = 100;
    const LoopEvent& e = attempt.event;
    std::string html = e.accepted ? "<tr class=\"accepted\">" : "<tr>";
    std::string verdict = "accepted";
    if (!e.accepted)
        verdict = escaped(e.reason);
    else if (e.kind != LoopKind::Relocalisation && e.nodes == 0)
        verdict = "accepted; the map fitted already";
    html += number_cell(when(data, attempt.frame)) + "<td>" + name_of(e.kind) + "</td><td>" + verdict + "</td>" +
            number_cell(model_frame(data, e)) + number_cell(fixed_text(kPercent * static_cast<double>(e.overlap), 0)) +
            measured_cell(0, kPercent * static_cast<double>(e.inlier_ratio)) +
            measured_cell(1, kMillimetres * static_cast<double>(e.icp_rmse_m)) +
            measured_cell(3, static_cast<double>(e.photometric_rmse)) +
            measured_cell(2, static_cast<double>(e.correlation)) +
            measured_cell(1, kMillimetres * e.residual_before_m) + measured_cell(1, kMillimetres * e.residual_after_m) +
            number_cell(e.nodes == 0 ? kNothing : std::to_string(e.nodes)) + measured_cell(0, e.solve_milliseconds) +
            number_cell(fixed_text(e.milliseconds, 0));
    return html + "</tr>\n";
}

std::string attempt_table(const ReportData& data, const std::vector<LoopAttempt>& attempts) {
    std::string html = "<div class=\"wide\"><table class=\"attempts\"><tr>";
    html += "<th class=\"number\">frame</th><th>kind</th><th>result</th>";
    for (const char* column : {"older frame", "overlap %", "inliers %", "ICP mm", "photo&shy;metric",
                               "corre&shy;lation", "before mm", "after mm", "nodes", "solve ms", "ms"})
        html += std::string("<th class=\"number\">") + column + "</th>";
    html += "</tr>\n";
    for (const LoopAttempt& attempt : attempts) html += attempt_row(data, attempt);
    return html + "</table></div>\n";
}

/// A heading; a long table below it is folded.
std::string folding(const std::string& heading, std::size_t rows, const std::string& content) {
    return std::string("<details") + (rows < kLongTable ? " open" : "") + "><summary>" + heading + "</summary>\n" +
           content + "</details>\n";
}

std::string lost_table(const ReportData& data) {
    std::string html =
        "<table><tr><th class=\"number\">from frame</th><th class=\"number\">to frame</th><th "
        "class=\"number\">frames</th><th></th></tr>\n";
    for (const LostInterval& lost : data.lost)
        html += "<tr>" + number_cell(when(data, lost.first)) + number_cell(when(data, lost.last)) +
                number_cell(std::to_string(lost.frames())) + "<td>" +
                (lost.found_again ? "found again" : "not found again before the end") + "</td></tr>\n";
    return html + "</table>\n";
}

std::string summary(const ReportData& data, const std::vector<LoopAttempt>& attempts) {
    const auto count = [&](auto&& is_counted) {
        return static_cast<std::size_t>(
            std::count_if(attempts.begin(), attempts.end(), [&](const LoopAttempt& a) { return is_counted(a.event); }));
    };
    const auto accepted = [&](LoopKind kind) {
        return count([&](const LoopEvent& event) { return event.accepted && event.kind == kind; });
    };
    const std::size_t closed = count([](const LoopEvent& event) { return event.closes_loop(); });
    const std::size_t looked =
        count([](const LoopEvent& event) { return event.kind == LoopKind::Local || event.kind == LoopKind::Global; });
    std::size_t lost = 0;
    for (const LostInterval& interval : data.lost) lost += interval.frames();

    std::string html = "<p>" + (closed == 0 ? "No loop" : counted(closed, "loop", "loops")) + " closed in " +
                       counted(looked, "attempt", "attempts") + ", " +
                       counted(data.keyframes.size(), "keyframe", "keyframes") + ". ";
    if (const std::size_t joined = accepted(LoopKind::Join); joined > 0)
        html += counted(joined, "piece", "pieces") + " of map joined. ";
    if (lost == 0) return html + "Tracking was never lost.</p>\n";
    return html + "Without tracking: " + counted(lost, "frame", "frames") + " in " +
           counted(data.lost.size(), "interval", "intervals") + "; " +
           counted(accepted(LoopKind::Relocalisation), "relocalisation", "relocalisations") + ".</p>\n";
}

}  // namespace

std::vector<LoopAttempt> loop_attempts(const ReportData& data) {
    std::vector<LoopAttempt> attempts;
    for (std::size_t i = 0; i < data.frames.size(); ++i)
        for (const LoopEvent& event : data.frames[i].loops) attempts.push_back({i, event});
    return attempts;
}

std::vector<LoopLink> loop_links(const ReportData& data) {
    std::vector<LoopLink> links;
    for (const LoopAttempt& attempt : loop_attempts(data)) {
        if (!attempt.event.accepted || attempt.event.kind == LoopKind::Relocalisation) continue;
        const auto live = camera_of_run(data, attempt.frame), model = camera_position(data, attempt.event.model_frame);
        if (live && model) links.push_back({*live, *model});
    }
    return links;
}

std::vector<Eigen::Vector3d> relocalised_positions(const ReportData& data) {
    std::vector<Eigen::Vector3d> positions;
    for (const LoopAttempt& attempt : loop_attempts(data)) {
        if (!attempt.event.accepted || attempt.event.kind != LoopKind::Relocalisation) continue;
        if (const auto position = camera_of_run(data, attempt.frame)) positions.push_back(*position);
    }
    return positions;
}

std::vector<Eigen::Vector3d> keyframe_positions(const ReportData& data) {
    std::vector<Eigen::Vector3d> positions;
    for (const std::uint32_t frame : data.keyframes)
        if (const auto position = camera_position(data, frame)) positions.push_back(*position);
    return positions;
}

std::vector<std::size_t> keyframes_of_run(const ReportData& data) {
    std::vector<std::size_t> frames;
    for (const std::size_t frame : data.keyframes)
        if (frame >= data.earlier_poses.size()) frames.push_back(frame - data.earlier_poses.size());
    return frames;
}

std::string loops_html(const ReportData& data, const std::string& figure) {
    const std::vector<LoopAttempt> attempts = loop_attempts(data);
    std::vector<LoopAttempt> accepted, refused;
    for (const LoopAttempt& attempt : attempts) (attempt.event.accepted ? accepted : refused).push_back(attempt);
    std::string html = summary(data, attempts) + figure;
    if (!accepted.empty())
        html += folding("Accepted: " + std::to_string(accepted.size()), accepted.size(), attempt_table(data, accepted));
    if (!refused.empty())
        html +=
            folding("Not accepted: " + std::to_string(refused.size()), refused.size(), attempt_table(data, refused));
    if (!data.lost.empty())
        html += folding("Without tracking: " + counted(data.lost.size(), "interval", "intervals"), data.lost.size(),
                        lost_table(data));
    return html;
}

std::string marks_html(const ReportData& data) {
    const std::vector<LoopAttempt> attempts = loop_attempts(data);
    const auto accepted = [&](bool relocalisation) {
        return std::any_of(attempts.begin(), attempts.end(), [&](const LoopAttempt& a) {
            return a.event.accepted && (a.event.kind == LoopKind::Relocalisation) == relocalisation;
        });
    };
    std::string html;
    if (!data.lost.empty()) html += "<i class=\"lost\"></i>not tracked";
    if (accepted(false)) html += "<i class=\"loop\"></i>loop closed";
    if (accepted(true)) html += "<i class=\"relocalised\"></i>found again";
    if (!keyframes_of_run(data).empty()) html += "<i class=\"keyframe\"></i>keyframe (tick at the foot)";
    return html.empty() ? html : "<p class=\"key with-plots\">In plots over time: " + html + "</p>\n";
}

}  // namespace posefusion
