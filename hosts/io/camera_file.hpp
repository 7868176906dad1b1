#pragma once
#include <Eigen/Geometry>
#include <filesystem>
#include <optional>

#include "engine/core/intrinsics.hpp"
#include "hosts/io/depth_deformation.hpp"
#include "hosts/io/lens.hpp"

/// The description of a camera that is needed to use its recordings, and the files that contain it.
namespace posefusion {

struct Camera {
    Intrinsics intrinsics;
    float depth_scale = 5000.0f;     ///< depth image value of one metre
    LensCoefficients distortion{};   ///< the same for colour and registered depth
    DepthDeformation deformation{};  ///< of depth, in the undistorted image
    [[nodiscard]] bool distorted() const { return distortion != LensCoefficients{}; }
};

/// The camera of depth images that are not registered to colour.
struct DepthCamera {
    Intrinsics intrinsics;
    LensCoefficients distortion{};
    Eigen::Isometry3f T_color_depth = Eigen::Isometry3f::Identity();  ///< metres
};

/// The content of a camera file.
struct CameraDescription {
    Camera camera;                     ///< of colour; width and height are 0 where the file does not say the size
    bool says_depth_scale = false;     ///< false: camera.depth_scale is the default
    std::optional<DepthCamera> depth;  ///< where depth is not registered
    bool y_up = false;  ///< the file has a negative fy: in its camera and world y points up. `camera` has y down.
};

/// The format of a file is recognised by its content:
///   - our own YAML: fx fy cx cy width height (needed), depth_scale (5000), k1 k2 p1 p2 k3 k4 k5 k6 (OpenCV's rational
///     model, 0), depth_deformation (a list of the nodes, row by row, 0); where depth is not registered depth_width
///     depth_height and, unless it is the same camera in another size, depth_fx depth_fy depth_cx depth_cy, depth_k1
///     ... depth_k6 and T_color_depth (4x4, row by row, metres)
///   - ORB-SLAM's settings (Camera.fx or Camera1.fx ..., DepthMapFactor or RGBD.DepthMapFactor)
///   - OpenCV's FileStorage in YAML and ROS's camera_info in YAML (camera_matrix, distortion_coefficients ...)
///   - Open3D's JSON (intrinsic_matrix, by columns) and that of Replica (camera: w h fx fy cx cy scale)
///   - numbers only: fx fy cx cy (ETH3D, ElasticFusion) or a 3x3 or 4x4 matrix (SUN3D, ScanNet)
/// Unknown and duplicate keys are errors. Throws Error naming the file, the key and what to do, also for lens models
/// that cannot be undistorted (fisheye).
[[nodiscard]] CameraDescription read_camera_description(const std::filesystem::path& file);

/// The same of the text of such a file. @param name  of where it comes from, for messages
[[nodiscard]] CameraDescription parse_camera_description(const std::string& text, const std::string& name);

/// The same for files that must be complete, with registered depth: without image size, or with a separate depth
/// camera, they are rejected. @param default_depth_scale  where the file has none
[[nodiscard]] Camera read_camera_file(const std::filesystem::path& file, float default_depth_scale = 5000.0f);

/// The same camera with images of another size: the centre of a block of pixels stays where it is.
[[nodiscard]] Intrinsics resized(const Intrinsics& camera, int width, int height);

/// Writes a file that read_camera_file() reads back bit for bit. Atomic; throws Error.
void write_camera_file(const std::filesystem::path& file, const Camera& camera);

}  // namespace posefusion
