#include <string>

#include "hosts/evaluate/evaluation.hpp"
#include "hosts/python/arrays.hpp"
#include "hosts/python/bindings.hpp"

namespace posefusion::python {
namespace {

/// Poses from an array, or from the file that anything else names.
Trajectory trajectory_from(const py::object& source) {
    if (py::isinstance<py::array>(source)) return trajectory_of(source.cast<py::array>());
    return read_trajectory(std::string(py::str(source)));
}

std::string evaluation_text(const py::object& groundtruth, const py::object& estimate, double max_stamp_difference,
                            double rpe_delta) {
    const Trajectory truth = trajectory_from(groundtruth), estimated = trajectory_from(estimate);
    const Unlocked unlocked;
    return evaluation_json(evaluate(truth, estimated, {max_stamp_difference, rpe_delta}));
}

}  // namespace

void define_evaluation(py::module_& module) { module.def("evaluation_text", &evaluation_text); }

}  // namespace posefusion::python
