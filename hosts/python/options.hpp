#pragma once
#include <pybind11/pybind11.h>

#include "hosts/config/run_config.hpp"

namespace posefusion::python {

/// Options given from Python. @param config   None, the path of a YAML file, or a dict with the same keys as that
/// file, nested
/// ({"tracking": {"icp": False}}) or dotted ({"tracking.icp": False})
/// @param options  a dict of the same form; takes precedence over `config`. Throws Error naming the key.
[[nodiscard]] RunConfig config_of(const pybind11::object& config, const pybind11::dict& options);

}  // namespace posefusion::python
