#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/python/arrays.hpp"
#include "hosts/python/bindings.hpp"
#include "hosts/python/paths.hpp"
#include "hosts/python/unlocked.hpp"

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
    const auto finite = [](std::initializer_list<float> numbers) {
        return std::all_of(numbers.begin(), numbers.end(), [](float number) { return std::isfinite(number); });
    };
    if (!camera.intrinsics.valid() || !(depth_scale > 0) || !finite({fx, fy, cx, cy, depth_scale})) {
        throw Error(
            "the camera makes no sense: focal lengths, image size and depth_scale must be above 0, and all finite");
    }
    if (!std::all_of(distortion.begin(), distortion.end(), [](float k) { return std::isfinite(k); }))
        throw Error("the camera makes no sense: its distortion must be finite numbers");
    return camera;
}

std::unique_ptr<Recording> open_recording(const std::filesystem::path& source,
                                          const std::optional<std::filesystem::path>& camera_file) {
    SourceOptions options;
    options.camera_file = camera_file.value_or("");
    options.cancelled = is_to_end;
    return interruptible([&] { return std::make_unique<Recording>(source, options); });
}

std::size_t length_of_recording(const Recording& recording) {
    if (recording.live()) throw py::type_error(recording.name() + " has no len(): a camera gives frames without end");
    return recording.size();
}

Frame load_unlocked(const Recording& recording, std::size_t i) {
    return interruptible([&] { return recording.load(i); });
}

/// Stamp, colour, depth in metres.
py::tuple tuple_of(Frame frame) {
    return py::make_tuple(to_seconds(frame.stamp), array_of(std::move(frame.color)), array_of(std::move(frame.depth)));
}

py::tuple frame_of_recording(const Recording& recording, std::size_t i) {
    if (i >= recording.size()) throw py::index_error("the recording has " + counted(recording.size(), "frame"));
    return tuple_of(load_unlocked(recording, i));
}

/// Goes through a recording as a run does: what cannot be read is skipped with a warning.
class RecordingIterator {
public:
    explicit RecordingIterator(const Recording& recording) : recording_(recording), bad_frames_(recording.size()) {}

    py::tuple next() {
        while (next_ < recording_.size()) {
            try {
                Frame frame = load_unlocked(recording_, next_++);
                bad_frames_.good();
                return tuple_of(std::move(frame));
            } catch (const SourceEnded&) {
                break;
            } catch (const SourceLost&) {
                throw;
            } catch (const Error& error) {
                warn(bad_frames_.bad(error.what()));
            }
        }
        throw py::stop_iteration();
    }

private:
    static void warn(const std::string& text) {
        if (PyErr_WarnEx(PyExc_RuntimeWarning, text.c_str(), 1) != 0) throw py::error_already_set();
    }

    const Recording& recording_;
    BadFrames bad_frames_;
    std::size_t next_ = 0;
};

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
            "from_file", [](const std::filesystem::path& file) { return read_camera_file(file); }, py::arg("file"))
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

template <>
inline constexpr bool kKnownToPython<RecordingIterator> = true;

void define_recording(py::module_& module) {
    define_camera(module);
    py::class_<Recording>(module, "Recording")
        .def(py::init(&open_recording), py::arg("source"), py::arg("camera_file") = py::none())
        .def("__len__", &length_of_recording)
        .def("__getitem__", &frame_of_recording, py::arg("index"))
        .def(
            "__iter__", [](const Recording& recording) { return RecordingIterator(recording); }, py::keep_alive<0, 1>())
        .def_property_readonly("camera", &camera_of_recording);
    py::class_<RecordingIterator>(module, "RecordingIterator")
        .def("__iter__", [](py::object self) { return self; })
        .def("__next__", &RecordingIterator::next);
}

}  // namespace posefusion::python
