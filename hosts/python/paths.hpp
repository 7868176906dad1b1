#pragma once
#include <pybind11/pybind11.h>
#include <pybind11/stl/filesystem.h>

#include <filesystem>

namespace posefusion::python {

/// Of a str, bytes or os.PathLike; for the rest TypeError, as open() has it.
[[nodiscard]] inline std::filesystem::path path_of(const pybind11::handle& object) {
    const auto path = pybind11::reinterpret_steal<pybind11::object>(PyOS_FSPath(object.ptr()));
    if (!path) throw pybind11::error_already_set();
    return path.cast<std::filesystem::path>();
}

}  // namespace posefusion::python
