#pragma once
#include <string>

#include "hosts/report/report.hpp"

namespace posefusion {

/// The data that page.js plots: series over time and the trajectories in upright axes (upright_axes), as JSON escaped
/// for an HTML script element.
[[nodiscard]] std::string run_json(const ReportData& data, const Eigen::Isometry3d& upright);

}  // namespace posefusion
