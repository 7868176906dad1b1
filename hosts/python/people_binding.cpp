#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "engine/core/error.hpp"
#include "hosts/io/camera_file.hpp"
#include "hosts/python/arrays.hpp"
#include "hosts/python/bindings.hpp"
#include "hosts/python/exclusive.hpp"
#include "hosts/python/options.hpp"
#include "pose/detector.hpp"
#include "segmentation/segmenter.hpp"

namespace posefusion::python {
namespace {

class PyDetector {
public:
    explicit PyDetector(const RunConfig& config)
        : detector_("Detector", [&] { return make_joint_detector(config.pose); }) {}
    py::array detect(const py::array& rgb) {
        const ColorImage color = color_of(rgb);
        return array_of(detector_.use([&](JointDetector& detector) { return detector.detect(color); }));
    }
    std::string description() {
        return detector_.use([](JointDetector& detector) { return detector.description(); });
    }

private:
    Exclusive<JointDetector> detector_;
};

class PySegmenter {
public:
    PySegmenter(const Camera& camera, const RunConfig& config)
        : depth_scale_(camera.depth_scale), segmenter_("Segmenter", [&] {
              return make_segmenter(config.segmentation, camera.intrinsics, config.slam.noise);
          }) {
        if (camera.distorted())
            throw Error("the segmenter takes undistorted images; give it a camera without distortion");
    }
    py::tuple segment(const py::array& rgb, const py::array& depth, const std::optional<py::array>& joints,
                      const std::optional<py::array>& motion) {
        const ColorImage color = color_of(rgb);
        const DepthImage metres = depth_of(depth, depth_scale_);
        std::optional<People> people;
        if (joints) people = people_of(*joints);
        const Eigen::Isometry3f T_previous_current =
            motion ? pose_of(*motion).cast<float>() : Eigen::Isometry3f::Identity();
        Segmentation result = segmenter_.use(
            [&](Segmenter& segmenter) { return segmenter.segment(color, metres, people, T_previous_current); });
        DepthImage without_people = remove_people(metres, result.labels);
        return py::make_tuple(array_of(std::move(result.labels)), array_of(std::move(without_people)));
    }

private:
    float depth_scale_;
    Exclusive<Segmenter> segmenter_;
};

}  // namespace

template <>
inline constexpr bool kKnownToPython<PyDetector> = true;
template <>
inline constexpr bool kKnownToPython<PySegmenter> = true;

void define_people(py::module_& module) {
    py::class_<PyDetector>(module, "Detector")
        .def(py::init([](const py::object& config, const py::kwargs& options) {
                 return std::make_unique<PyDetector>(config_of(config, options));
             }),
             py::arg("config") = py::none())
        .def("detect", &PyDetector::detect, py::arg("rgb"))
        .def_property_readonly("description", &PyDetector::description);
    py::class_<PySegmenter>(module, "Segmenter")
        .def(py::init([](const Camera& camera, const py::object& config, const py::kwargs& options) {
                 return std::make_unique<PySegmenter>(camera, config_of(config, options));
             }),
             py::arg("camera"), py::arg("config") = py::none())
        .def("segment", &PySegmenter::segment, py::arg("rgb"), py::arg("depth"), py::arg("joints") = py::none(),
             py::arg("motion") = py::none());
}

}  // namespace posefusion::python
