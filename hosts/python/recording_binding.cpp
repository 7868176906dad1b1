#include <pybind11/stl.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/error.hpp"
#include "hosts/io/camera_file.hpp"
#include "hosts/io/recording.hpp"
#include "hosts/python/arrays.hpp"
#include "hosts/python/bindings.hpp"

namespace posefusion::python {
namespace {

Camera make_camera(float fx, float fy, float cx, float cy, int width, int height, float depth_scale,
                   const std::vector<float>& distortion) {
    Camera camera;
    camera.intrinsics = {fx, fy, cx, cy, width, height};
    camera.depth_scale = depth_scale;
    if (distortion.size() > camera.distortion.size())
        throw Error("distortion has at most 8 coefficients: k1 k2 p1 p2 k3 k4 k5 k6");
    std::copy(distortion.begin(), distortion.end(), camera.distortion.begin());
    if (!camera.intrinsics.valid() || !(depth_scale > 0)) {
        throw Error("the camera makes no sense: focal lengths, image size and depth_scale must be above 0");
    }
    return camera;
}

std::unique_ptr<Recording> open_recording(const py::object& source, const py::object& camera_file) {
    SourceOptions options;
    if (!camera_file.is_none()) options.camera_file = std::string(py::str(camera_file));
    return std::make_unique<Recording>(std::string(py::str(source)), options);
}

std::size_t length_of_recording(const Recording& recording) {
    if (recording.live()) throw py::type_error(recording.name() + " has no len(): a camera gives frames without end");
    return recording.size();
}

/// Frame i of a recording: stamp, colour, depth in metres.
py::tuple frame_of_recording(const Recording& recording, std::size_t i) {
    if (i >= recording.size()) throw py::index_error();  // ends a loop over the recording
    Frame frame;
    {
        const Unlocked unlocked;
        frame = recording.load(i);
    }
    return py::make_tuple(to_seconds(frame.stamp), array_of(std::move(frame.color)), array_of(std::move(frame.depth)));
}

Camera camera_of_recording(const Recording& recording) {
    Camera camera;
    camera.intrinsics = recording.intrinsics();
    return camera;
}

void define_camera(py::module_& module) {
    const Camera defaults;
    py::class_<Camera>(module, "Camera")
        .def(py::init(&make_camera), py::arg("fx"), py::arg("fy"), py::arg("cx"), py::arg("cy"), py::arg("width"),
             py::arg("height"), py::arg("depth_scale") = defaults.depth_scale,
             py::arg("distortion") = std::vector<float>{})
        .def_static(
            "from_file", [](const py::object& file) { return read_camera_file(std::string(py::str(file))); },
            py::arg("file"))
        .def_property_readonly("fx", [](const Camera& c) { return c.intrinsics.fx; })
        .def_property_readonly("fy", [](const Camera& c) { return c.intrinsics.fy; })
        .def_property_readonly("cx", [](const Camera& c) { return c.intrinsics.cx; })
        .def_property_readonly("cy", [](const Camera& c) { return c.intrinsics.cy; })
        .def_property_readonly("width", [](const Camera& c) { return c.intrinsics.width; })
        .def_property_readonly("height", [](const Camera& c) { return c.intrinsics.height; })
        .def_readonly("depth_scale", &Camera::depth_scale)
        .def_readonly("distortion", &Camera::distortion);
}

}  // namespace

void define_recording(py::module_& module) {
    define_camera(module);
    py::class_<Recording>(module, "Recording")
        .def(py::init(&open_recording), py::arg("source"), py::arg("camera_file") = py::none())
        .def("__len__", &length_of_recording)
        .def("__getitem__", &frame_of_recording, py::arg("index"))
        .def_property_readonly("camera", &camera_of_recording);
}

}  // namespace posefusion::python
