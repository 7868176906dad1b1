#include <pybind11/stl.h>

#include <optional>
#include <string>

#include "engine/core/error.hpp"
#include "hosts/evaluate/evaluation.hpp"
#include "hosts/evaluate/time_offset.hpp"
#include "hosts/evaluate/trajectory_pair.hpp"
#include "hosts/python/arrays.hpp"
#include "hosts/python/bindings.hpp"
#include "hosts/python/paths.hpp"
#include "hosts/python/unlocked.hpp"

namespace posefusion::python {
namespace {

bool is_array(const py::object& source) { return py::isinstance<py::array>(source); }

/// Poses from an array, or from a file if given a path.
Trajectory trajectory_from(const py::object& source) {
    if (is_array(source)) return trajectory_of(source.cast<py::array>());
    return read_trajectory(path_of(source));
}

template <class Values>
auto value_named(const Values& values, const std::string& name, const char* argument) {
    std::string names;
    for (const auto value : values) {
        if (name == name_of(value)) return value;
        names += (names.empty() ? "" : ", ") + std::string(name_of(value));
    }
    throw Error(std::string(argument) + ": '" + name + "' is none of " + names);
}

/// @param time_offset  seconds; nullopt: the best fit
std::string evaluation_text(const py::object& groundtruth, const py::object& estimate, double max_stamp_difference,
                            double rpe_delta, const std::string& rpe_delta_unit, bool rpe_all_pairs,
                            const std::string& align, bool scale, const std::string& match,
                            std::optional<double> time_offset) {
    const EvaluationConfig config{
        {stamp_of(max_stamp_difference), value_named(kMatchingRules, match, "match")},
        {value_named(kAlignmentRules, align, "align"), scale},
        {rpe_delta, value_named(kDeltaUnits, rpe_delta_unit, "rpe_delta_unit"), rpe_all_pairs}};
    Trajectory truth, estimated;
    if (is_array(groundtruth) || is_array(estimate)) {
        truth = trajectory_from(groundtruth);
        estimated = trajectory_from(estimate);
    } else {
        TrajectoryPair pair = read_trajectory_pair(path_of(groundtruth), path_of(estimate));
        if (!pair.timed && config.rpe.unit == DeltaUnit::Seconds)
            throw Error("the trajectories have no time stamps; give rpe_delta_unit 'frames', 'm' or 'deg'");
        truth = std::move(pair.groundtruth.poses);
        estimated = std::move(pair.estimate.poses);
    }
    const Unlocked unlocked;
    TimeOffsetConfig search;
    search.scale = scale;
    const Stamp offset = time_offset ? stamp_of(*time_offset) : find_time_offset(truth, estimated, search);
    return evaluation_json(evaluate(truth, shifted(std::move(estimated), offset), config));
}

}  // namespace

void define_evaluation(py::module_& module) { module.def("evaluation_text", &evaluation_text); }

}  // namespace posefusion::python
