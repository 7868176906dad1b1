#pragma once
#include "hosts/io/frame_source.hpp"

namespace posefusion {

/// ROS 1 bags. Colour: sensor_msgs/Image (rgb8, bgr8, rgba8, bgra8, mono8) or CompressedImage (JPEG, PNG); depth: Image
/// (16UC1 in millimetres; 32FC1 in metres, kept to 0.2 mm) or CompressedImage (compressedDepth PNG), registered to
/// colour. The topics are options.color_topic and depth_topic, else those whose names say what they are, registered
/// depth before other. Time stamps are those of the message headers; colour and depth are paired within 20 ms.
///
/// The camera is options.camera_file, else the CameraInfo beside the colour topic, with its lens distortion
/// (plumb_bob) unless the topic holds rectified images.
[[nodiscard]] std::unique_ptr<FrameSource> open_bag(const std::filesystem::path& file, const SourceOptions& options);

}  // namespace posefusion
