#include <pybind11/stl.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "hosts/io/ply.hpp"
#include "hosts/library/version.hpp"
#include "hosts/pipeline/posefusion.hpp"
#include "hosts/python/arrays.hpp"
#include "hosts/python/bindings.hpp"
#include "hosts/python/options.hpp"

namespace posefusion::python {
namespace {

struct PyFrame {
    py::array pose, covariance;
    std::string tracking;
    py::object joints, labels;
    int people;
    float icp_rmse_m, photometric_rmse;
    std::uint32_t surfels, stable_surfels;
    py::list loops;
};

PyFrame frame_of(ProcessedFrame tracked) {
    const FrameResult& result = tracked.result;
    Segmentation& segmentation = tracked.people.segmentation;
    PyFrame frame;
    frame.pose = array_of(result.T_world_camera);
    py::array_t<double> covariance({6, 6});
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(covariance.mutable_data()) = result.covariance;
    frame.covariance = std::move(covariance);
    frame.tracking = name_of(result.tracking);
    frame.joints = tracked.people.joints ? py::object(array_of(*tracked.people.joints)) : py::none();
    frame.people = segmentation.people;
    frame.labels =
        segmentation.labels.empty() ? py::object(py::none()) : py::object(array_of(std::move(segmentation.labels)));
    frame.icp_rmse_m = result.icp_rmse_m;
    frame.photometric_rmse = result.photometric_rmse;
    frame.surfels = result.surfels;
    frame.stable_surfels = result.stable_surfels;
    for (const LoopEvent& loop : result.loops) {
        py::dict entry;
        entry["frame"] = loop.frame;
        entry["kind"] = name_of(loop.kind);
        entry["model_frame"] = loop.model_frame;
        entry["accepted"] = loop.accepted;
        entry["reason"] = loop.reason;
        frame.loops.append(entry);
    }
    return frame;
}

class PyPoseFusion {
    /// Runs `call` without the GIL, but with the lock of this object.
    template <class Call>
    auto locked(Call&& call) {
        const Unlocked unlocked;
        const std::lock_guard lock(mutex_);
        return call();
    }

public:
    PyPoseFusion(const Camera& camera, const RunConfig& config) : depth_scale_(camera.depth_scale) {
        const Unlocked unlocked;
        method_ = std::make_unique<PoseFusion>(camera, config);
    }

    PyFrame process(const py::array& rgb, const py::array& depth, double stamp, const std::optional<py::array>& mask) {
        ColorImage color = color_of(rgb);
        DepthImage metres = depth_of(depth, depth_scale_);
        std::optional<LabelImage> labels;
        if (mask) labels = labels_of(*mask);
        return frame_of(locked(
            [&] { return method_->process(std::move(color), std::move(metres), stamp_of(stamp), std::move(labels)); }));
    }

    py::array surfels(bool stable_only) {
        return array_of(locked([&] { return method_->engine().surfels(stable_only); }));
    }
    py::array trajectory() {
        return array_of(locked([&] { return method_->trajectory(); }));
    }
    py::tuple render(const py::array& pose) {
        const Eigen::Isometry3d T_world_camera = pose_of(pose);
        ModelView view = locked([&] { return method_->engine().render(T_world_camera); });
        return py::make_tuple(array_of(std::move(view.color)), array_of(std::move(view.depth)));
    }
    void save_trajectory(const std::string& file) {
        locked([&] { write_trajectory(file, method_->trajectory()); });
    }
    void save_map(const std::string& file, bool stable_only) {
        locked([&] {
            write_ply(file, method_->engine().surfels(stable_only), {std::string("made by PoseFusion ") + version()});
        });
    }
    std::string device() { return method_->engine().device().name; }

private:
    std::mutex mutex_;
    float depth_scale_;
    std::unique_ptr<PoseFusion> method_;
};

}  // namespace

void define_posefusion(py::module_& module) {
    py::class_<PyFrame>(module, "Frame")
        .def_readonly("pose", &PyFrame::pose)
        .def_readonly("covariance", &PyFrame::covariance)
        .def_readonly("tracking", &PyFrame::tracking)
        .def_readonly("joints", &PyFrame::joints)
        .def_readonly("labels", &PyFrame::labels)
        .def_readonly("people", &PyFrame::people)
        .def_readonly("icp_rmse_m", &PyFrame::icp_rmse_m)
        .def_readonly("photometric_rmse", &PyFrame::photometric_rmse)
        .def_readonly("surfels", &PyFrame::surfels)
        .def_readonly("stable_surfels", &PyFrame::stable_surfels)
        .def_readonly("loops", &PyFrame::loops);
    py::class_<PyPoseFusion>(module, "PoseFusion")
        .def(py::init([](const Camera& camera, const py::object& config, const py::kwargs& options) {
                 return std::make_unique<PyPoseFusion>(camera, config_of(config, options));
             }),
             py::arg("camera"), py::arg("config") = py::none())
        .def("process", &PyPoseFusion::process, py::arg("rgb"), py::arg("depth"), py::arg("stamp"),
             py::arg("mask") = py::none())
        .def("surfels", &PyPoseFusion::surfels, py::arg("stable_only") = true)
        .def("trajectory", &PyPoseFusion::trajectory)
        .def("render", &PyPoseFusion::render, py::arg("pose"))
        .def(
            "save_trajectory", [](PyPoseFusion& slam, const py::object& file) { slam.save_trajectory(py::str(file)); },
            py::arg("file"))
        .def(
            "save_map",
            [](PyPoseFusion& slam, const py::object& file, bool stable_only) {
                slam.save_map(py::str(file), stable_only);
            },
            py::arg("file"), py::arg("stable_only") = true)
        .def_property_readonly("device", &PyPoseFusion::device);
}

}  // namespace posefusion::python
