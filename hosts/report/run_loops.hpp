#pragma once
#include <string>
#include <vector>

#include "hosts/report/report.hpp"

/// Loops, keyframes and lost cameras in the report. Frames are counted from the first one of the run.
namespace posefusion {

/// An attempt and the frame of the run in which it was made.
struct LoopAttempt {
    std::size_t frame = 0;
    LoopEvent event;
};
[[nodiscard]] std::vector<LoopAttempt> loop_attempts(const ReportData& data);

/// The two ends of a closed loop: where the camera was, and where the older view was taken. World frame.
struct LoopLink {
    Eigen::Vector3d live = Eigen::Vector3d::Zero(), model = Eigen::Vector3d::Zero();
};
[[nodiscard]] std::vector<LoopLink> loop_links(const ReportData& data);
/// Positions at which the camera was relocalised. World frame.
[[nodiscard]] std::vector<Eigen::Vector3d> relocalised_positions(const ReportData& data);

/// Positions of keyframes, those of a loaded map included. World frame.
[[nodiscard]] std::vector<Eigen::Vector3d> keyframe_positions(const ReportData& data);
/// The keyframes of this run.
[[nodiscard]] std::vector<std::size_t> keyframes_of_run(const ReportData& data);

/// Counts, the figure, the tables of attempts and of lost intervals, as HTML.
[[nodiscard]] std::string loops_html(const ReportData& data, const std::string& figure);

/// The legend of the marks in the plots over time, as HTML; empty if there are none.
[[nodiscard]] std::string marks_html(const ReportData& data);

}  // namespace posefusion
