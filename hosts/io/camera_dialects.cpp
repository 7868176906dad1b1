#include "hosts/io/camera_dialects.hpp"

#include <cmath>
#include <string>
#include <vector>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

using Names = std::vector<std::string>;

/// The key of `names` that exists; of synonyms only one may.
std::string one_of(const CameraKeys& keys, const Names& names) {
    std::string found;
    for (const std::string& name : names) {
        if (!keys.has(name)) continue;
        if (!found.empty()) keys.fail("'" + found + "' and '" + name + "' mean the same; leave one of them");
        found = name;
    }
    return found;
}

void take_size(const CameraKeys& keys, const Names& width, const Names& height, Camera& camera) {
    const std::string w = one_of(keys, width), h = one_of(keys, height);
    if (w.empty() != h.empty()) keys.fail("'" + (w.empty() ? width : height).front() + "' is missing");
    if (w.empty()) return;
    camera.intrinsics.width = keys.side(w);
    camera.intrinsics.height = keys.side(h);
}

void take_depth_scale(const CameraKeys& keys, const Names& names, CameraDescription& description) {
    const std::string name = one_of(keys, names);
    description.says_depth_scale = !name.empty();
    if (!name.empty()) description.camera.depth_scale = keys.positive(name);
}

/// Settings of ORB-SLAM 2 (Camera.fx) and 3 (Camera1.fx).
CameraDescription describe_orb_slam(const CameraKeys& keys) {
    const std::string prefix = keys.has("Camera1.fx") ? "Camera1." : "Camera.";
    const Names coefficients{"k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"};
    Names known{"Camera.width",        "Camera.height", "DepthMapFactor",
                "RGBD.DepthMapFactor", "Camera.type",   "File.version"};
    for (const char* name : {"fx", "fy", "cx", "cy"}) known.push_back(prefix + name);
    for (const std::string& name : coefficients) known.push_back(prefix + name);
    Names other_programs{
        "Camera.fps", "Camera.bf", "Camera.RGB",  "Camera.newWidth", "Camera.newHeight", "Camera.imageScale",
        "Camera2.",   "ThDepth",   "Stereo.",     "ORBextractor.",   "Viewer.",          "System.",
        "RGBD.",      "IMU.",      "loopClosing", "thFarPoints"};
    if (prefix == "Camera1.") other_programs.push_back("Camera1.overlapping");
    keys.expect_only(known, other_programs);

    const std::string model = keys.has("Camera.type") ? keys.text("Camera.type") : "";
    if (is_wide_angle_model(model)) keys.fail("'Camera.type' is '" + model + "'; " + kWideAngleAdvice);
    CameraDescription description;
    Intrinsics& K = description.camera.intrinsics;
    K = {keys.positive(prefix + "fx"),
         keys.number(prefix + "fy"),
         keys.number(prefix + "cx"),
         keys.number(prefix + "cy"),
         0,
         0};
    for (std::size_t i = 0; i < coefficients.size(); ++i)
        description.camera.distortion[i] = keys.number(prefix + coefficients[i], 0);
    take_size(keys, {"Camera.width"}, {"Camera.height"}, description.camera);
    take_depth_scale(keys, {"RGBD.DepthMapFactor", "DepthMapFactor"}, description);
    return description;
}

const Names kMatrixNames{"camera_matrix", "cameraMatrix", "Camera_Matrix", "camera_Matrix", "K", "k"};

/// OpenCV's calibration, ROS's calibration and ROS's camera_info message.
CameraDescription describe_matrix_file(const CameraKeys& keys) {
    const Names lens{"distortion_coefficients", "distCoeffs", "Distortion_Coefficients", "dist_coeffs", "D", "d"};
    const Names width{"image_width", "image_Width", "width"}, height{"image_height", "image_Height", "height"};
    const Names model{"distortion_model", "camera_model", "model"};
    Names known{"depth_scale", "depth_factor"};
    for (const Names* names : {&kMatrixNames, &lens, &width, &height, &model})
        known.insert(known.end(), names->begin(), names->end());
    keys.expect_only(known, {"camera_name",
                             "rectification_matrix",
                             "projection_matrix",
                             "header",
                             "binning",
                             "roi",
                             "R",
                             "P",
                             "r",
                             "p",
                             "calibration_",
                             "calibrationDate",
                             "nframes",
                             "nrOfFrames",
                             "nr_of_frames",
                             "board_",
                             "square_",
                             "marker_",
                             "flags",
                             "fisheye_model",
                             "avg_reprojection_error",
                             "Avg_Reprojection_Error",
                             "per_view",
                             "Per_View",
                             "extrinsic_parameters",
                             "Extrinsic_Parameters",
                             "image_points",
                             "Image_points",
                             "grid_points",
                             "aspectRatio",
                             "fixed_aspect",
                             "FixAspectRatio",
                             "fps",
                             "name"});
    if (keys.has("fisheye_model") && keys.number("fisheye_model") != 0)
        keys.fail(std::string("'fisheye_model' is set; ") + kWideAngleAdvice);
    CameraDescription description;
    description.camera.intrinsics = keys.matrix(one_of(keys, kMatrixNames), false);
    const std::string model_key = one_of(keys, model);
    description.camera.distortion = keys.lens(one_of(keys, lens), model_key.empty() ? "" : keys.text(model_key));
    take_size(keys, width, height, description.camera);
    take_depth_scale(keys, {"depth_scale", "depth_factor"}, description);
    return description;
}

/// open3d.camera.PinholeCameraIntrinsic.
CameraDescription describe_open3d_intrinsic(const CameraKeys& keys) {
    keys.expect_only(
        {"width", "height", "intrinsic_matrix", "depth_scale"},
        {"class_name", "version_", "color_", "depth_", "device_", "serial_number", "stream_length_usec", "fps"});
    CameraDescription description;
    description.camera.intrinsics = keys.matrix("intrinsic_matrix", true);
    take_size(keys, {"width"}, {"height"}, description.camera);
    take_depth_scale(keys, {"depth_scale"}, description);
    return description;
}

/// open3d.camera.PinholeCameraParameters: the same, and a pose, which is that of one image.
CameraDescription describe_open3d_parameters(const CameraKeys& file) {
    file.expect_only({"intrinsic"}, {"class_name", "version_", "extrinsic"});
    return describe_open3d_intrinsic(file.map("intrinsic"));
}

/// cam_params.json of the Replica renderings.
CameraDescription describe_replica(const CameraKeys& file) {
    file.expect_only({"camera"});
    const CameraKeys keys = file.map("camera");
    keys.expect_only({"w", "h", "fx", "fy", "cx", "cy", "scale"});
    CameraDescription description;
    description.camera.intrinsics = {
        keys.positive("fx"), keys.number("fy"), keys.number("cx"), keys.number("cy"), 0, 0};
    take_size(keys, {"w"}, {"h"}, description.camera);
    take_depth_scale(keys, {"scale"}, description);
    return description;
}

}  // namespace

std::optional<CameraDescription> describe_foreign_camera(const CameraKeys& keys) {
    if (keys.has_prefix("Camera.") || keys.has_prefix("Camera1.")) return describe_orb_slam(keys);
    if (keys.has("intrinsic_matrix")) return describe_open3d_intrinsic(keys);
    if (keys.has("intrinsic")) return describe_open3d_parameters(keys);
    if (keys.has("camera")) return describe_replica(keys);
    for (const std::string& name : kMatrixNames)
        if (keys.has(name)) return describe_matrix_file(keys);
    return std::nullopt;
}

CameraDescription describe_numbers(std::span<const double> numbers, const std::filesystem::path& file) {
    CameraDescription description;
    const auto at = [&](std::size_t i) { return static_cast<float>(numbers[i]); };
    const std::size_t columns = numbers.size() == 16 ? 4 : 3;
    if (numbers.size() == 4) {
        description.camera.intrinsics = {at(0), at(1), at(2), at(3), 0, 0};
    } else if (numbers.size() == 9 || numbers.size() == 16) {
        if (at(1) != 0 || at(columns) != 0 || at(2 * columns + 2) != 1)
            throw Error(file.string() + ": is no camera matrix: expected rows fx 0 cx, 0 fy cy, 0 0 1");
        description.camera.intrinsics = {at(0), at(columns + 1), at(2), at(columns + 2), 0, 0};
    } else {
        throw Error(file.string() + ": holds " + std::to_string(numbers.size()) +
                    " numbers; expected fx fy cx cy, or a camera matrix of 3x3 or 4x4, or lines `name: value`");
    }
    if (!(description.camera.intrinsics.fx > 0)) throw Error(file.string() + ": the focal length fx must be positive");
    return description;
}

CameraDescription with_y_down(CameraDescription description) {
    if (!(description.camera.intrinsics.fy < 0)) return description;
    description.y_up = true;
    description.camera.intrinsics.fy *= -1;
    description.camera.distortion[2] *= -1;  // p1: the terms of the tangential part that are even in y
    return description;
}

}  // namespace posefusion
