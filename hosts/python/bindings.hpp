#pragma once
#include <pybind11/pybind11.h>

/// The compiled part of the Python package; posefusion/__init__.pyi documents its interface. Computations release the
/// GIL; calls of several threads on one object are serialised.
namespace posefusion::python {

namespace py = pybind11;
using Unlocked = py::gil_scoped_release;

void define_recording(py::module_& module);   ///< Camera, Recording
void define_posefusion(py::module_& module);  ///< Frame, PoseFusion
void define_people(py::module_& module);      ///< Detector, Segmenter
void define_evaluation(py::module_& module);  ///< evaluation_text

}  // namespace posefusion::python
