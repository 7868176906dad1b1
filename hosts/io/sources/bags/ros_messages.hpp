#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <string>
#include <vector>

#include "hosts/io/camera_file.hpp"
#include "hosts/io/image_file.hpp"
#include "hosts/io/sources/bags/ros_reader.hpp"
#include "hosts/io/stamp.hpp"

/// The messages of ROS that matter here, from their serialised form (sensor_msgs, http://wiki.ros.org/sensor_msgs).
/// Those of ROS 2 have the same fields in the same order; their types are named here without the `msg` in the middle.
/// All throw Error that starts with `name` for a message that is damaged or of an unknown kind.
namespace posefusion {

inline constexpr const char* kImageType = "sensor_msgs/Image";
inline constexpr const char* kCompressedImageType = "sensor_msgs/CompressedImage";
inline constexpr const char* kCameraInfoType = "sensor_msgs/CameraInfo";
inline constexpr const char* kTransformType = "geometry_msgs/Transform";
inline constexpr const char* kTransformsType = "tf2_msgs/TFMessage";
inline constexpr const char* kOldTransformsType = "tf/tfMessage";
inline constexpr const char* kFloatType = "std_msgs/Float32";

/// The number of bytes that ros_stamp() needs: sequence number or encapsulation, seconds, nanoseconds.
inline constexpr std::size_t kStampedBytes = 12;

/// The stamp in the header: when the image was taken, according to the driver; 0 if unset.
[[nodiscard]] Stamp ros_stamp(const RosMessage& message, const std::string& name);

/// The content of a topic, from one of its messages.
struct RosImageKind {
    std::string frame_id;  ///< of the header
    std::string encoding;  ///< "16UC1", "rgb8", ...; for compressed images that of the original, if known
    ImageSize size;
};
[[nodiscard]] RosImageKind ros_image_kind(const RosMessage& message, bool compressed, const std::string& name);

/// Encodings that ros_depth() reads and that are always depth; mono16 may be infrared and is not among them.
[[nodiscard]] bool is_depth_encoding(const std::string& encoding);
/// Encodings that ros_color() reads: true colour (Bayer and YUV included), and grey.
[[nodiscard]] bool is_color_encoding(const std::string& encoding);
[[nodiscard]] bool is_grey_encoding(const std::string& encoding);

/// Bayer patterns and YUV 4:2:2 are converted by OpenCV; grey is r = g = b.
[[nodiscard]] ColorImage ros_color(const RosMessage& message, bool compressed, const std::string& name, ImageSize size);

/// Raw, or as compressed_depth_image_transport packs it: PNG or RVL, float depth as quantised inverse depth.
[[nodiscard]] RawDepth ros_depth(const RosMessage& message, bool compressed, const std::string& name, ImageSize size);
struct RosCamera {
    std::string frame_id;
    Camera camera;
    std::string warning;  ///< what was ignored
};
/// @param rectified  the images are rectified: their camera is P, without distortion. Throws Error for a camera that
/// was not calibrated and for unsupported lens models (fisheye).
[[nodiscard]] RosCamera ros_camera(const RosMessage& camera_info, bool rectified, const std::string& name);

/// T_parent_child of geometry_msgs/Transform (RealSense) ...
[[nodiscard]] Eigen::Isometry3d ros_transform(const RosMessage& message, const std::string& name);
/// ... and those of a tf2_msgs/TFMessage or tf/tfMessage.
struct RosTransform {
    std::string parent, child;
    Eigen::Isometry3d T_parent_child;
};
[[nodiscard]] std::vector<RosTransform> ros_transforms(const RosMessage& message, const std::string& name);

/// std_msgs/Float32.
[[nodiscard]] float ros_float(const RosMessage& message, const std::string& name);

}  // namespace posefusion
