#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "hosts/report/report.hpp"

/// Rigid things that moved, in the report.
namespace posefusion {

/// Where the object was in the frames of the run, world frame. A NaN stands between two frames in which it was tracked,
/// if it was not in those between.
[[nodiscard]] std::vector<Eigen::Vector3d> object_positions(const ReportData& data, const ObjectOfRun& object);

/// Metres along the path. Positions nearer than kPathJitter to the last one that counts do not: the errors of many
/// poses would add up.
[[nodiscard]] double path_length(const Trajectory& trajectory);
inline constexpr double kPathJitter = 0.02;  ///< metres

/// "rgb(230, 159, 0)"
[[nodiscard]] std::string css_color(Rgb8 color);

/// A section with a table of the objects, as HTML; empty if there are none.
[[nodiscard]] std::string objects_html(const ReportData& data);

}  // namespace posefusion
