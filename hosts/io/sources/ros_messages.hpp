#pragma once
#include <cstdint>
#include <string>

#include "hosts/io/camera_file.hpp"
#include "hosts/io/image_file.hpp"
#include "hosts/io/input_file.hpp"

/// The messages of ROS 1 that matter here, from their serialised form (sensor_msgs, http://wiki.ros.org/sensor_msgs).
/// All throw Error that starts with `name` for a message that is damaged, or of a kind that is not known.
namespace posefusion {

inline constexpr const char* kImageType = "sensor_msgs/Image";
inline constexpr const char* kCompressedImageType = "sensor_msgs/CompressedImage";
inline constexpr const char* kCameraInfoType = "sensor_msgs/CameraInfo";

/// ByteBuffer from which ros_stamp() can be read.
inline constexpr std::size_t kStampedBytes = 12;

struct RosStamp {
    std::uint32_t seconds = 0, nanoseconds = 0;
    [[nodiscard]] double value() const;      ///< seconds
    [[nodiscard]] std::string text() const;  ///< seconds with 6 decimals, or 9 where they are needed
};
[[nodiscard]] RosStamp ros_stamp(const ByteBuffer& message, const std::string& name);

[[nodiscard]] ColorImage ros_color(const ByteBuffer& message, bool compressed, const std::string& name, ImageSize size);

[[nodiscard]] RawDepth ros_depth(const ByteBuffer& message, bool compressed, const std::string& name, ImageSize size);
/// 1000 for 16-bit images, 5000 for float ones.
[[nodiscard]] float ros_depth_scale(const ByteBuffer& message, bool compressed, const std::string& name);

[[nodiscard]] ImageSize ros_image_size(const ByteBuffer& message, bool compressed, const std::string& name);

/// @param rectified  the images are: the distortion does not count. `warning` is set where something was left out.
[[nodiscard]] Camera ros_camera(const ByteBuffer& camera_info, bool rectified, const std::string& name,
                                std::string& warning);

}  // namespace posefusion
