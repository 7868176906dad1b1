#include <pybind11/stl.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/slam/slam_state.hpp"
#include "hosts/io/map_file.hpp"
#include "hosts/io/ply.hpp"
#include "hosts/library/version.hpp"
#include "hosts/pipeline/posefusion.hpp"
#include "hosts/python/arrays.hpp"
#include "hosts/python/bindings.hpp"
#include "hosts/python/exclusive.hpp"
#include "hosts/python/options.hpp"
#include "hosts/python/paths.hpp"

namespace posefusion::python {
namespace {

struct PyMovingObject {
    int label;
    py::array pose;
    std::uint32_t pixels;
};

}  // namespace

template <>
inline constexpr bool kKnownToPython<PyMovingObject> = true;

namespace {

struct PyFrame {
    py::array pose, covariance;
    std::string tracking;
    py::object joints, labels, movers;
    int people;
    float icp_rmse_m, photometric_rmse;
    std::uint32_t surfels, stable_surfels;
    py::list objects, loops;
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
    frame.movers =
        result.movers.empty() ? py::object(py::none()) : py::object(array_of(std::move(tracked.result.movers)));
    frame.icp_rmse_m = result.icp_rmse_m;
    frame.photometric_rmse = result.photometric_rmse;
    frame.surfels = result.surfels;
    frame.stable_surfels = result.stable_surfels;
    for (const MovingObject& object : result.objects)
        frame.objects.append(
            PyMovingObject{object.label, array_of(result.T_world_camera * object.T_camera_object), object.pixels});
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

/// Goes on in a map of an earlier run, wherever in it the camera may be.
void continue_in_map(PoseFusion& method, const std::filesystem::path& file) {
    const SlamState map = read_map(file);
    if (map.frames == 0) throw Error(file.string() + ": is an empty map; begin without one");
    method.continue_in(map);
}

class PyPoseFusion {
public:
    PyPoseFusion(const Camera& camera, const RunConfig& config)
        : depth_scale_(camera.depth_scale), method_("PoseFusion", [&] {
              auto method = std::make_unique<PoseFusion>(camera, config);
              if (!config.load_map.empty()) continue_in_map(*method, config.load_map);
              return method;
          }) {}

    PyFrame process(const py::array& rgb, const py::array& depth, double stamp, const std::optional<py::array>& mask) {
        ColorImage color = color_of(rgb);
        DepthImage metres = depth_of(depth, depth_scale_);
        std::optional<LabelImage> labels;
        if (mask) labels = labels_of(*mask);
        return frame_of(method_.use([&](PoseFusion& method) {
            return method.process(std::move(color), std::move(metres), stamp_of(stamp), std::move(labels));
        }));
    }

    py::array surfels(bool stable_only) {
        return array_of(method_.use([&](PoseFusion& method) { return method.engine().surfels(stable_only); }));
    }
    py::dict object_maps(bool stable_only) {
        py::dict maps;
        for (ObjectMap& map : method_.use([&](PoseFusion& method) { return method.object_maps(stable_only); }))
            maps[py::int_(map.label)] = array_of(std::move(map.surfels));
        return maps;
    }
    py::array trajectory() {
        return array_of(method_.use([](PoseFusion& method) { return method.trajectory(); }));
    }
    py::tuple render(const py::array& pose) {
        const Eigen::Isometry3d T_world_camera = pose_of(pose);
        ModelView view = method_.use([&](PoseFusion& method) { return method.engine().render(T_world_camera); });
        return py::make_tuple(array_of(std::move(view.color)), array_of(std::move(view.depth)));
    }
    void save_trajectory(const std::filesystem::path& file) {
        method_.use([&](PoseFusion& method) { write_trajectory(file, method.trajectory()); });
    }
    void save_surfels(const std::filesystem::path& file, bool stable_only) {
        method_.use([&](PoseFusion& method) {
            write_ply(file, method.engine().surfels(stable_only), {std::string("made by PoseFusion ") + version()});
        });
    }
    void save_map(const std::filesystem::path& file) {
        if (file.extension() == ".ply")
            throw Error(file.string() + ": save_map() writes the complete map, .pfmap; save_surfels() writes .ply");
        method_.use([&](PoseFusion& method) { write_map(file, method.engine().state()); });
    }
    void load_map(const std::filesystem::path& file) {
        method_.use([&](PoseFusion& method) { continue_in_map(method, file); });
    }
    std::string device() {
        return method_.use([](PoseFusion& method) { return method.engine().device().name; });
    }

private:
    float depth_scale_;
    Exclusive<PoseFusion> method_;
};

}  // namespace

template <>
inline constexpr bool kKnownToPython<PyFrame> = true;
template <>
inline constexpr bool kKnownToPython<PyPoseFusion> = true;

void define_posefusion(py::module_& module) {
    py::class_<PyMovingObject>(module, "MovingObject")
        .def_readonly("label", &PyMovingObject::label)
        .def_readonly("pose", &PyMovingObject::pose)
        .def_readonly("pixels", &PyMovingObject::pixels);
    py::class_<PyFrame>(module, "Frame")
        .def_readonly("pose", &PyFrame::pose)
        .def_readonly("covariance", &PyFrame::covariance)
        .def_readonly("tracking", &PyFrame::tracking)
        .def_readonly("joints", &PyFrame::joints)
        .def_readonly("labels", &PyFrame::labels)
        .def_readonly("movers", &PyFrame::movers)
        .def_readonly("people", &PyFrame::people)
        .def_readonly("icp_rmse_m", &PyFrame::icp_rmse_m)
        .def_readonly("photometric_rmse", &PyFrame::photometric_rmse)
        .def_readonly("surfels", &PyFrame::surfels)
        .def_readonly("stable_surfels", &PyFrame::stable_surfels)
        .def_readonly("objects", &PyFrame::objects)
        .def_readonly("loops", &PyFrame::loops);
    py::class_<PyPoseFusion>(module, "PoseFusion")
        .def(py::init([](const Camera& camera, const py::object& config, const py::kwargs& options) {
                 return std::make_unique<PyPoseFusion>(camera, config_of(config, options));
             }),
             py::arg("camera"), py::arg("config") = py::none())
        .def("process", &PyPoseFusion::process, py::arg("rgb"), py::arg("depth"), py::arg("stamp"),
             py::arg("mask") = py::none())
        .def("surfels", &PyPoseFusion::surfels, py::arg("stable_only") = true)
        .def("object_maps", &PyPoseFusion::object_maps, py::arg("stable_only") = true)
        .def("trajectory", &PyPoseFusion::trajectory)
        .def("render", &PyPoseFusion::render, py::arg("pose"))
        .def("save_trajectory", &PyPoseFusion::save_trajectory, py::arg("file"))
        .def("save_surfels", &PyPoseFusion::save_surfels, py::arg("file"), py::arg("stable_only") = true)
        .def("save_map", &PyPoseFusion::save_map, py::arg("file"))
        .def("load_map", &PyPoseFusion::load_map, py::arg("file"))
        .def_property_readonly("device", &PyPoseFusion::device);
}

}  // namespace posefusion::python
