#pragma once
#include <optional>
#include <string>
#include <vector>

#include "hosts/io/frame_source.hpp"
#include "hosts/io/sources/bags/message_bag.hpp"
#include "hosts/io/sources/bags/ros_messages.hpp"

/// Chooses the topics of colour and depth in a bag, and their cameras.
namespace posefusion {

/// A topic of images, described by its first message.
struct BagTopic {
    std::string name;
    bool compressed = false;
    RosImageKind kind;                ///< empty where the first message cannot be read
    std::string camera_topic;         ///< topic of its camera_info; empty = none
    std::optional<RosCamera> camera;  ///< empty also if unusable: then camera_fault says why
    std::string camera_fault;
};

struct BagTopics {
    BagTopic color, depth;
    bool registered = true;             ///< the depth images are of the colour camera
    std::vector<std::string> warnings;  ///< what was chosen where there was a choice
};

/// The best matching pair of topics. Decided first by the content of the messages: their encoding, and whether depth
/// has the size, frame and camera of colour (then it is registered); then by names. options.color_topic and depth_topic
/// take precedence. Throws Error: no such topic, no colour or no depth.
[[nodiscard]] BagTopics choose_topics(const MessageBag& bag, const SourceOptions& options);

/// The first message of that type on the topic that can be read; nullopt if there is none on it. Throws Error: damaged.
[[nodiscard]] std::optional<RosMessage> first_message(const MessageBag& bag, const std::string& topic,
                                                      const std::string& type);

}  // namespace posefusion
