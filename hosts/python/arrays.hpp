#pragma once
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>
#include <utility>

#include "engine/core/image.hpp"
#include "engine/slam/slam.hpp"
#include "hosts/io/trajectory.hpp"
#include "pose/joints.hpp"

/// Conversion between NumPy arrays and our types. Input is copied once, since the caller may change it while the GIL is
/// released; output is handed over without a copy. All throw Error naming the array, its shape and the expected one.
namespace posefusion::python {

namespace py = pybind11;

[[nodiscard]] ColorImage color_of(const py::array& array);   ///< (height, width, 3) uint8, R G B
[[nodiscard]] LabelImage labels_of(const py::array& array);  ///< (height, width) uint8 or bool
/// (height, width): uint16 in units of 1 / depth_scale metres, or float metres; values that are not finite count as not
/// measured
[[nodiscard]] DepthImage depth_of(const py::array& array, float depth_scale);
[[nodiscard]] Eigen::Isometry3d pose_of(const py::array& array);  ///< (4, 4), rigid
[[nodiscard]] Trajectory trajectory_of(const py::array& array);   ///< (n, 8): stamp tx ty tz qx qy qz qw
[[nodiscard]] People people_of(const py::array& joints);          ///< (n, 18, 3): u v p, the most certain person first

[[nodiscard]] py::array array_of(ColorImage image);
[[nodiscard]] py::array array_of(DepthImage image);
[[nodiscard]] py::array array_of(LabelImage image);
[[nodiscard]] py::array array_of(const Eigen::Isometry3d& pose);
[[nodiscard]] py::array array_of(const Trajectory& trajectory);
[[nodiscard]] py::array array_of(const People& people);
[[nodiscard]] py::array array_of(std::vector<Surfel> surfels);  ///< (n) records with the members of Surfel

}  // namespace posefusion::python
