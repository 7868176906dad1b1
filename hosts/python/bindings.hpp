#pragma once
#include <pybind11/pybind11.h>

#include "hosts/io/camera_file.hpp"
#include "hosts/io/recording.hpp"
#include "hosts/python/initialised.hpp"

/// The compiled part of the Python package; posefusion/__init__.pyi documents its interface. Computations release the
/// GIL; calls of several threads on one object are serialised.
namespace posefusion::python {

namespace py = pybind11;

template <>
inline constexpr bool kKnownToPython<Camera> = true;
template <>
inline constexpr bool kKnownToPython<Recording> = true;

void define_recording(py::module_& module);   ///< Camera, Recording, RecordingIterator
void define_posefusion(py::module_& module);  ///< MovingObject, Frame, PoseFusion
void define_people(py::module_& module);      ///< Detector, Segmenter
void define_evaluation(py::module_& module);  ///< evaluation_text

}  // namespace posefusion::python
