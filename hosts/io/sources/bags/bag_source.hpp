#pragma once
#include <memory>
#include <string>

#include "hosts/io/frame_source.hpp"
#include "hosts/io/sources/bags/message_bag.hpp"

namespace posefusion {

/// The frames of a bag, of ROS 1 or 2. Colour: sensor_msgs/Image (rgb8, bgr8, rgba8, bgra8, mono8, Bayer, YUV 4:2:2) or
/// CompressedImage (JPEG, PNG); depth: Image (16UC1, mono16, 32FC1) or CompressedImage (compressedDepth in PNG or RVL).
/// choose_topics() says which topics, find_bag_camera() which cameras; depth that is not registered to colour is. Time
/// stamps are those of the message headers, or the times of recording where the headers have none or never agree (said
/// in a warning); colour and depth are paired within 20 ms.
/// @param name  short name of the recording
[[nodiscard]] std::unique_ptr<FrameSource> frames_of_bag(std::unique_ptr<MessageBag> bag, std::string name,
                                                         const SourceOptions& options);

}  // namespace posefusion
