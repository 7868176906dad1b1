#pragma once
#include <optional>
#include <string>
#include <vector>

#include "hosts/io/frame_source.hpp"
#include "hosts/io/sources/bag_file.hpp"
#include "hosts/io/sources/ros_messages.hpp"

/// Which topics of a bag hold colour and depth, and of which cameras they are.
namespace posefusion {

/// A topic of images, by its first message.
struct BagTopic {
    std::string name;
    bool compressed = false;
    RosImageKind kind;                ///< empty where the first message cannot be read
    std::string camera_topic;         ///< with the camera_info that belongs to it; empty = there is none
    std::optional<RosCamera> camera;  ///< empty also where it cannot be used: then camera_fault says why
    std::string camera_fault;
};

struct BagTopics {
    BagTopic color, depth;
    bool registered = true;             ///< the depth images are of the colour camera
    std::vector<std::string> warnings;  ///< what was chosen where there was a choice
};

/// The pair of topics that fit together best. What counts is, first, what the messages hold: their encoding, that depth
/// has the size, the frame and the camera of colour (then it is registered); names are a hint where that leaves a
/// choice. options.color_topic and depth_topic go before. Throws Error: no such topic, no colour or no depth.
[[nodiscard]] BagTopics choose_topics(const BagFile& bag, const SourceOptions& options);

/// The first usable message of that type on the topic; nullopt if there is none.
[[nodiscard]] std::optional<ByteBuffer> first_message(const BagFile& bag, const std::string& topic,
                                                      const std::string& type);

}  // namespace posefusion
