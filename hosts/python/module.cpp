#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "engine/core/error.hpp"
#include "hosts/evaluate/evaluation.hpp"
#include "hosts/io/camera_file.hpp"
#include "hosts/io/ply.hpp"
#include "hosts/io/sequence.hpp"
#include "hosts/library/version.hpp"
#include "hosts/pipeline/frame_by_frame.hpp"
#include "hosts/python/arrays.hpp"
#include "hosts/python/options.hpp"
#include "pose/detector.hpp"
#include "segmentation/segmenter.hpp"

/// The compiled part of the Python package; posefusion/__init__.pyi documents what it offers. Computing releases Python's lock;
/// calls of several threads on one object take turns.
namespace posefusion::python {
namespace {

using Unlocked = py::gil_scoped_release;

Camera make_camera(float fx, float fy, float cx, float cy, int width, int height, float depth_scale, const std::array<float, 5>& distortion) {
    Camera camera;
    camera.intrinsics = {fx, fy, cx, cy, width, height};
    camera.depth_scale = depth_scale;
    camera.distortion = distortion;
    if (!camera.intrinsics.valid() || !(depth_scale > 0)) {
        throw Error("the camera makes no sense: focal lengths, image size and depth_scale must be above 0");
    }
    return camera;
}

const char* name_of(TrackingState state) {
    switch (state) {
        case TrackingState::FirstFrame:
            return "first frame";
        case TrackingState::Ok:
            return "ok";
        case TrackingState::Failed:
            return "failed";
        case TrackingState::Lost:
            return "lost";
        case TrackingState::Relocalised:
            return "relocalised";
    }
    return "";
}

const char* name_of(LoopKind kind) {
    switch (kind) {
        case LoopKind::Local:
            return "local";
        case LoopKind::Global:
            return "global";
        case LoopKind::Relocalisation:
            return "relocalisation";
    }
    return "";
}

struct PyFrame {
    py::array pose, covariance;
    std::string tracking;
    py::object joints, labels;
    int people;
    float icp_rmse_m, photometric_rmse;
    std::uint32_t surfels, stable_surfels;
    py::list loops;
};

PyFrame frame_of(FrameByFrame::Result result) {
    PyFrame frame;
    frame.pose = array_of(result.slam.T_world_camera);
    py::array_t<double> covariance({6, 6});
    Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>(covariance.mutable_data()) = result.slam.covariance;
    frame.covariance = std::move(covariance);
    frame.tracking = name_of(result.slam.tracking);
    frame.joints = result.people.joints ? py::object(array_of(*result.people.joints)) : py::none();
    Segmentation& segmentation = result.people.segmentation;
    frame.people = segmentation.people;
    frame.labels = segmentation.labels.empty() ? py::object(py::none()) : py::object(array_of(std::move(segmentation.labels)));
    frame.icp_rmse_m = result.slam.icp_rmse_m;
    frame.photometric_rmse = result.slam.photometric_rmse;
    frame.surfels = result.slam.surfels;
    frame.stable_surfels = result.slam.stable_surfels;
    for (const LoopEvent& loop : result.slam.loops) {
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

class PySlam {
    /// Runs `call` without Python's lock, but alone on this object.
    template <class Call>
    auto locked(Call&& call) {
        const Unlocked unlocked;
        const std::lock_guard lock(mutex_);
        return call();
    }

public:
    PySlam(const Camera& camera, const RunConfig& config) : depth_scale_(camera.depth_scale) {
        const Unlocked unlocked;
        method_ = std::make_unique<FrameByFrame>(camera, config);
    }

    PyFrame process(const py::array& rgb, const py::array& depth, double stamp, const std::optional<py::array>& mask) {
        ColorImage color = color_of(rgb);
        DepthImage metres = depth_of(depth, depth_scale_);
        std::optional<LabelImage> labels;
        if (mask) labels = labels_of(*mask);
        return frame_of(locked([&] { return method_->process(stamp, std::move(color), std::move(metres), std::move(labels)); }));
    }

    py::array surfels(bool stable_only) {
        return array_of(locked([&] { return method_->slam().surfels(stable_only); }));
    }
    py::array trajectory() {
        return array_of(locked([&] { return method_->trajectory(); }));
    }
    py::tuple render(const py::array& pose) {
        const Eigen::Isometry3d T_world_camera = pose_of(pose);
        ModelView view = locked([&] { return method_->slam().render(T_world_camera); });
        return py::make_tuple(array_of(std::move(view.color)), array_of(std::move(view.depth)));
    }
    void save_trajectory(const std::string& file) {
        locked([&] { write_trajectory(file, method_->trajectory()); });
    }
    void save_map(const std::string& file, bool stable_only) {
        locked([&] { write_ply(file, method_->slam().surfels(stable_only), {std::string("made by PoseFusion ") + version()}); });
    }
    std::string device() { return method_->slam().device().name; }

private:
    std::mutex mutex_;
    float depth_scale_;
    std::unique_ptr<FrameByFrame> method_;
};

class PyDetector {
public:
    explicit PyDetector(const RunConfig& config) {
        const Unlocked unlocked;
        detector_ = make_joint_detector(config.pose);
    }
    py::array detect(const py::array& rgb) {
        const ColorImage color = color_of(rgb);
        People people;
        {
            const Unlocked unlocked;
            const std::lock_guard lock(mutex_);
            people = detector_->detect(color);
        }
        return array_of(people);
    }
    std::string description() { return detector_->description(); }

private:
    std::mutex mutex_;
    std::unique_ptr<JointDetector> detector_;
};

class PySegmenter {
public:
    PySegmenter(const Camera& camera, const RunConfig& config)
        : depth_scale_(camera.depth_scale), segmenter_(make_segmenter(config.segmentation, camera.intrinsics)) {
        if (camera.distorted()) throw Error("the segmenter takes undistorted images; give it a camera without distortion");
    }
    py::tuple segment(const py::array& rgb, const py::array& depth, const std::optional<py::array>& joints, const std::optional<py::array>& motion) {
        const ColorImage color = color_of(rgb);
        const DepthImage metres = depth_of(depth, depth_scale_);
        std::optional<People> people;
        if (joints) people = people_of(*joints);
        const Eigen::Isometry3f T_previous_current = motion ? pose_of(*motion).cast<float>() : Eigen::Isometry3f::Identity();
        Segmentation result;
        {
            const Unlocked unlocked;
            const std::lock_guard lock(mutex_);
            result = segmenter_->segment(color, metres, people, T_previous_current);
        }
        return py::make_tuple(array_of(std::move(result.labels)), array_of(std::move(result.static_depth)));
    }

private:
    std::mutex mutex_;
    float depth_scale_;
    std::unique_ptr<Segmenter> segmenter_;
};

/// Frame i of a recording: stamp, colour, depth in metres.
py::tuple frame_of_recording(const Sequence& recording, std::size_t i) {
    if (i >= recording.size()) throw py::index_error();  // ends a loop over the recording
    Frame frame;
    {
        const Unlocked unlocked;
        frame = recording.load(i);
    }
    return py::make_tuple(frame.stamp, array_of(std::move(frame.color)), array_of(std::move(frame.depth)));
}

Camera camera_of_recording(const Sequence& recording) {
    Camera camera;
    camera.intrinsics = recording.intrinsics();
    return camera;
}

/// Poses from an array, or from the file that anything else names.
Trajectory trajectory_from(const py::object& source) {
    if (py::isinstance<py::array>(source)) return trajectory_of(source.cast<py::array>());
    return read_trajectory(std::string(py::str(source)));
}

std::string evaluation_text(const py::object& groundtruth, const py::object& estimate, double max_stamp_difference, double rpe_delta) {
    const Trajectory truth = trajectory_from(groundtruth), estimated = trajectory_from(estimate);
    const Unlocked unlocked;
    return evaluation_json(evaluate(truth, estimated, {max_stamp_difference, rpe_delta}));
}

void define_slam(py::module_& module) {
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
    py::class_<PySlam>(module, "Slam")
        .def(py::init([](const Camera& camera, const py::object& config, const py::kwargs& options) {
                 return std::make_unique<PySlam>(camera, config_of(config, options));
             }),
             py::arg("camera"), py::arg("config") = py::none())
        .def("process", &PySlam::process, py::arg("rgb"), py::arg("depth"), py::arg("stamp"), py::arg("mask") = py::none())
        .def("surfels", &PySlam::surfels, py::arg("stable_only") = true)
        .def("trajectory", &PySlam::trajectory)
        .def("render", &PySlam::render, py::arg("pose"))
        .def("save_trajectory", [](PySlam& slam, const py::object& file) { slam.save_trajectory(py::str(file)); }, py::arg("file"))
        .def("save_map", [](PySlam& slam, const py::object& file, bool stable_only) { slam.save_map(py::str(file), stable_only); },
             py::arg("file"), py::arg("stable_only") = true)
        .def_property_readonly("device", &PySlam::device);
}

void define_people(py::module_& module) {
    py::class_<PyDetector>(module, "Detector")
        .def(py::init([](const py::object& config, const py::kwargs& options) { return std::make_unique<PyDetector>(config_of(config, options)); }),
             py::arg("config") = py::none())
        .def("detect", &PyDetector::detect, py::arg("rgb"))
        .def_property_readonly("description", &PyDetector::description);
    py::class_<PySegmenter>(module, "Segmenter")
        .def(py::init([](const Camera& camera, const py::object& config, const py::kwargs& options) {
                 return std::make_unique<PySegmenter>(camera, config_of(config, options));
             }),
             py::arg("camera"), py::arg("config") = py::none())
        .def("segment", &PySegmenter::segment, py::arg("rgb"), py::arg("depth"), py::arg("joints") = py::none(), py::arg("motion") = py::none());
}

void define_camera(py::module_& module) {
    const Camera defaults;
    py::class_<Camera>(module, "Camera")
        .def(py::init(&make_camera), py::arg("fx"), py::arg("fy"), py::arg("cx"), py::arg("cy"), py::arg("width"), py::arg("height"),
             py::arg("depth_scale") = defaults.depth_scale, py::arg("distortion") = defaults.distortion)
        .def_static("from_file", [](const py::object& file) { return read_camera_file(std::string(py::str(file))); }, py::arg("file"))
        .def_property_readonly("fx", [](const Camera& c) { return c.intrinsics.fx; })
        .def_property_readonly("fy", [](const Camera& c) { return c.intrinsics.fy; })
        .def_property_readonly("cx", [](const Camera& c) { return c.intrinsics.cx; })
        .def_property_readonly("cy", [](const Camera& c) { return c.intrinsics.cy; })
        .def_property_readonly("width", [](const Camera& c) { return c.intrinsics.width; })
        .def_property_readonly("height", [](const Camera& c) { return c.intrinsics.height; })
        .def_readonly("depth_scale", &Camera::depth_scale)
        .def_readonly("distortion", &Camera::distortion);
}

void define_recording(py::module_& module) {
    py::class_<Sequence>(module, "Recording")
        .def(py::init([](const py::object& source) { return std::make_unique<Sequence>(std::string(py::str(source))); }), py::arg("source"))
        .def("__len__", &Sequence::size)
        .def("__getitem__", &frame_of_recording, py::arg("index"))
        .def_property_readonly("camera", &camera_of_recording);
}

}  // namespace

PYBIND11_MODULE(_core, module) {
    module.attr("__version__") = version();
    py::register_exception<Error>(module, "Error", PyExc_RuntimeError);
    define_camera(module);
    define_recording(module);
    define_slam(module);
    define_people(module);
    module.def("evaluation_text", &evaluation_text);
}

}  // namespace posefusion::python
