#include "hosts/io/sources/bags/bag_topics.hpp"

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <map>
#include <string_view>
#include <utility>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

bool is_image_type(const std::string& type) { return type == kImageType || type == kCompressedImageType; }

bool names(const std::string& topic, std::initializer_list<std::string_view> words) {
    std::string lower = topic;
    std::transform(lower.begin(), lower.end(), lower.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return std::any_of(words.begin(), words.end(), [&](auto word) { return lower.find(word) != std::string::npos; });
}

/// The last parts of a topic's name say what it holds; those before belong to the camera or the robot.
std::string last_parts(const std::string& topic) {
    constexpr int kParts = 3;  // /NAMESPACE/rgb/image_color/compressed, /device_0/sensor_1/Color_0/image/data
    std::size_t at = topic.size();
    for (int i = 0; i < kParts && at != 0 && at != std::string::npos; ++i) at = topic.rfind('/', at - 1);
    return at == std::string::npos ? topic : topic.substr(at);
}

bool names_infrared(const std::string& topic) {
    return names(topic, {"infra", "/ir/", "/ir_", "_ir/", "confidence", "disparity", "fisheye", "theora"});
}

bool says_registered(const std::string& topic) {
    return names(topic, {"registered", "aligned", "depth_to_rgb", "depth_to_color"});
}

/// How many parts of their names two topics have in common from the beginning: /camera1/rgb and /camera1/depth have
/// one.
int common_parts(const std::string& a, const std::string& b) {
    const auto difference = std::mismatch(a.begin(), a.end(), b.begin(), b.end()).first;
    return static_cast<int>(std::count(a.begin(), difference, '/')) - 1;
}

// Weights of evidence: each outweighs all weaker kinds together. 0 or less: impossible.
constexpr int kContent = 64;    ///< the encoding says so
constexpr int kGeometry = 16;   ///< size, frame or camera agree
constexpr int kName = 4;        ///< a word in the name
constexpr int kPreference = 1;  ///< preference between equals: raw before compressed, rectified before distorted

int color_evidence(const BagTopic& topic) {
    const std::string& encoding = topic.kind.encoding;
    const std::string name = last_parts(topic.name);
    if (names_infrared(topic.name) || (!encoding.empty() && !is_color_encoding(encoding))) return 0;
    const bool named = names(name, {"rgb", "color", "colour"});
    if (encoding.empty() && !named && names(name, {"depth"})) return 0;
    int evidence = kPreference;
    if (!encoding.empty()) evidence += is_grey_encoding(encoding) ? kContent / 2 : kContent;
    if (topic.camera) evidence += kName;
    if (named) evidence += kName;
    if (names(name, {"to_depth", "mono"})) evidence -= kName;
    if (names(name, {"rect"})) evidence += 2 * kPreference;
    if (!topic.compressed) evidence += kPreference;
    return evidence;
}

int depth_evidence(const BagTopic& topic) {
    const std::string& encoding = topic.kind.encoding;
    const bool named = names(last_parts(topic.name), {"depth"});
    if (names_infrared(topic.name) || names(topic.name, {"rgb_to_depth", "color_to_depth"})) return 0;
    int evidence = 0;
    if (is_depth_encoding(encoding)) evidence += kContent;
    if (encoding == "mono16" && names(topic.name, {"depth"})) evidence += kContent;  // else it is infrared
    if (named) evidence += kName;
    if (evidence == 0 || (is_color_encoding(encoding) && !is_grey_encoding(encoding))) return 0;
    if (names(topic.name, {"registered", "aligned", "depth_to_rgb", "depth_to_color", "rect"})) evidence += kName;
    if (!topic.compressed) evidence += kPreference;
    return evidence;
}

bool same_size(const BagTopic& a, const BagTopic& b) { return a.kind.size.width > 0 && a.kind.size == b.kind.size; }
bool same_frame(const BagTopic& a, const BagTopic& b) {
    return !a.kind.frame_id.empty() && a.kind.frame_id == b.kind.frame_id;
}
bool same_camera(const BagTopic& a, const BagTopic& b) {
    return a.camera && b.camera && a.camera_topic != b.camera_topic &&
           a.camera->camera.intrinsics == b.camera->camera.intrinsics;
}

int evidence_for_pair(const BagTopic& color, const BagTopic& depth) {
    int evidence = std::min(common_parts(color.name, depth.name), kName - 1);
    for (const bool agree : {same_size(color, depth), same_frame(color, depth), same_camera(color, depth)})
        evidence += agree ? kGeometry : 0;
    return evidence;
}

std::vector<BagTopic> image_topics(const MessageBag& bag) {
    std::map<std::string, BagTopic> topics;
    for (const auto& [number, connection] : bag.connections())
        if (is_image_type(connection.type))
            topics.try_emplace(connection.topic,
                               BagTopic{connection.topic, connection.type == kCompressedImageType, {}, {}, {}, {}});
    std::vector<BagTopic> all;
    for (auto& [name, topic] : topics) {
        const std::string where = bag.name() + ", " + name;
        try {
            if (const auto message = first_message(bag, name, topic.compressed ? kCompressedImageType : kImageType))
                topic.kind = ros_image_kind(*message, topic.compressed, where);
        } catch (const Error&) {
            topic.kind = {};  // the error is reported when the topic is read
        }
        all.push_back(std::move(topic));
    }
    return all;
}

/// /camera/rgb/image_color/compressed belongs to /camera/rgb/camera_info, RealSense's
/// /device_0/sensor_1/Color_0/image/data to /device_0/sensor_1/Color_0/info/camera_info.
void find_camera(const MessageBag& bag, BagTopic& topic) {
    const bool rectified = names(last_parts(topic.name), {"image_rect", "rect_color", "rect_raw"});
    for (std::string folder = topic.name; folder.find('/') != std::string::npos;) {
        folder.erase(folder.rfind('/'));
        for (const char* info : {"/camera_info", "/info/camera_info"}) {
            const std::string name = folder + info, where = bag.name() + ", " + name;
            const auto message = first_message(bag, name, kCameraInfoType);
            if (!message) continue;
            topic.camera_topic = name;
            try {
                topic.camera = ros_camera(*message, rectified, where);
            } catch (const Error& error) {
                topic.camera_fault = error.what();
            }
            return;
        }
    }
}

std::string description_of(const BagTopic& topic) {
    std::string text = topic.name;
    if (topic.kind.size.width > 0)
        text += " (" + topic.kind.encoding + (topic.compressed ? ", compressed, " : ", ") + size_text(topic.kind.size) +
                ")";
    return text;
}

std::string list(const std::vector<BagTopic>& topics) {
    std::string all;
    for (const BagTopic& topic : topics) all += (all.empty() ? "" : ", ") + description_of(topic);
    return all.empty() ? "none" : all;
}

struct Candidate {
    const BagTopic* topic;
    int evidence;
};

/// @param given  the name the user gave; empty = any
template <class Evidence>
std::vector<Candidate> candidates(const MessageBag& bag, const std::vector<BagTopic>& topics, const std::string& given,
                                  const char* what, const char* option, Evidence evidence) {
    std::vector<Candidate> all;
    for (const BagTopic& topic : topics) {
        const int weight = given.empty() ? evidence(topic) : static_cast<int>(topic.name == given);
        if (weight > 0) all.push_back({&topic, weight});
    }
    if (all.empty() && !given.empty())
        throw Error(bag.name() + ": has no image topic " + given + "; it has " + list(topics));
    if (all.empty())
        throw Error(bag.name() + ": has no " + what + " images (its image topics: " + list(topics) +
                    "); name one with " + option);
    return all;
}

bool is_registered(const BagTopic& color, const BagTopic& depth) {
    if (same_frame(color, depth) || same_camera(color, depth) || says_registered(depth.name)) return true;
    return !depth.camera || depth.camera_topic == color.camera_topic;  // nothing indicates another camera
}

}  // namespace

std::optional<RosMessage> first_message(const MessageBag& bag, const std::string& topic, const std::string& type) {
    const auto& connections = bag.connections();
    const bool known = std::any_of(connections.begin(), connections.end(), [&](const auto& entry) {
        return entry.second.topic == topic && entry.second.type == type;
    });
    if (!known) return std::nullopt;
    constexpr std::size_t kMostTried = 30;  // as a damaged chunk may hold
    std::size_t tried = 0;
    std::optional<Error> fault;
    for (const MessageBag::Message& message : bag.messages({topic})) {
        if (tried++ == kMostTried) break;
        try {
            return bag.read(message);
        } catch (const Error& error) {
            if (!fault) fault = error;
        }
    }
    if (fault) throw Error(*fault);
    return std::nullopt;
}

BagTopics choose_topics(const MessageBag& bag, const SourceOptions& options) {
    std::vector<BagTopic> topics = image_topics(bag);
    for (BagTopic& topic : topics) find_camera(bag, topic);
    const auto colors = candidates(bag, topics, options.color_topic, "colour", "--color-topic", color_evidence);
    const auto depths = candidates(bag, topics, options.depth_topic, "depth", "--depth-topic", depth_evidence);

    std::optional<std::pair<const BagTopic*, const BagTopic*>> best;
    int best_evidence = 0;
    for (const Candidate& color : colors) {
        for (const Candidate& depth : depths) {
            if (color.topic == depth.topic) continue;
            const int evidence = color.evidence + depth.evidence + evidence_for_pair(*color.topic, *depth.topic);
            if (best && evidence <= best_evidence) continue;
            best = {color.topic, depth.topic};
            best_evidence = evidence;
        }
    }
    if (!best)
        throw Error(bag.name() + ": has images on one topic only, " + description_of(*colors.front().topic) +
                    "; colour and depth are needed");

    BagTopics chosen{*best->first, *best->second, is_registered(*best->first, *best->second), {}};
    if (colors.size() > 1 || depths.size() > 1) {
        std::vector<BagTopic> others;
        for (const BagTopic& topic : topics)
            if (topic.name != chosen.color.name && topic.name != chosen.depth.name) others.push_back(topic);
        chosen.warnings.push_back(bag.name() + ": colour is taken from " + description_of(chosen.color) +
                                  ", depth from " + description_of(chosen.depth) +
                                  (others.empty() ? "" : "; not from " + list(others)) +
                                  " (--color-topic and --depth-topic choose)");
    }
    return chosen;
}

}  // namespace posefusion
