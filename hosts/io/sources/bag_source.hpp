#pragma once
#include "hosts/io/frame_source.hpp"

namespace posefusion {

/// ROS 1 bags. Colour: sensor_msgs/Image (rgb8, bgr8, rgba8, bgra8, mono8, Bayer, YUV 4:2:2) or CompressedImage (JPEG,
/// PNG); depth: Image (16UC1, mono16, 32FC1) or CompressedImage (compressedDepth in PNG or RVL). choose_topics() says
/// which topics, find_bag_camera() which cameras; depth that is not registered to colour is. Time stamps are those of
/// the message headers, or the times of recording where the headers have none or never agree (said in a warning);
/// colour and depth are paired within 20 ms.
[[nodiscard]] std::unique_ptr<FrameSource> open_bag(const std::filesystem::path& file, const SourceOptions& options);

}  // namespace posefusion
