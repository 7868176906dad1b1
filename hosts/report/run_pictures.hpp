#pragma once
#include <cstdint>
#include <vector>

#include "hosts/report/report.hpp"

/// The pictures of a run for the report.
namespace posefusion {

/// The path of an object; a point that is not finite interrupts it.
struct ObjectPath {
    std::uint8_t label = 0;
    std::vector<Eigen::Vector3d> positions;
};

/// Positions in the axes of upright_axes: right, forward, up, metres.
struct Paths {
    std::vector<Eigen::Vector3d> estimate;
    std::vector<Eigen::Vector3d> groundtruth;  ///< during the run; aligned as for the ATE; may be empty
    std::vector<ObjectPath> objects;
};
[[nodiscard]] Paths upright_paths(const ReportData& data, const Eigen::Isometry3d& upright);

/// The paths from above and from the side and, with ground truth, the error over time.
[[nodiscard]] ColorImage trajectory_picture(const ReportData& data, const Paths& paths);
/// The map from above, behind the first camera.
[[nodiscard]] ColorImage map_overview(const std::vector<Surfel>& map, const Eigen::Isometry3d& upright);
/// The map as the first camera saw it, from a step back.
[[nodiscard]] ColorImage map_from_start(const std::vector<Surfel>& map, const ReportData& data);

}  // namespace posefusion
