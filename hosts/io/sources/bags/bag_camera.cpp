#include "hosts/io/sources/bags/bag_camera.hpp"

#include <cmath>
#include <deque>
#include <map>
#include <utility>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr const char* kRealSenseImage = "/image/data";
/// Messages read of /tf, which lasts as long as the recording; the transform between the cameras is among the first.
constexpr std::size_t kMostTransforms = 500;
constexpr double kMaxBaseline = 1.0;  ///< metres; cameras of one device are closer

std::string where(const MessageBag& bag, const std::string& topic) { return bag.name() + ", " + topic; }

/// RealSense's viewer: `STREAM/tf/GROUP` holds T_stream_reference, the reference being the same for a group.
std::optional<Eigen::Isometry3d> realsense_motion(const MessageBag& bag, const BagTopics& topics) {
    const auto stream_of = [](const std::string& topic) {
        return topic.ends_with(kRealSenseImage) ? topic.substr(0, topic.size() - std::string(kRealSenseImage).size())
                                                : "";
    };
    const std::string color = stream_of(topics.color.name), depth = stream_of(topics.depth.name);
    if (color.empty() || depth.empty()) return std::nullopt;
    for (const auto& [number, connection] : bag.connections()) {
        const std::string prefix = color + "/tf/";
        if (connection.type != kTransformType || !connection.topic.starts_with(prefix)) continue;
        const std::string depth_topic = depth + "/tf/" + connection.topic.substr(prefix.size());
        const auto of_color = first_message(bag, connection.topic, kTransformType),
                   of_depth = first_message(bag, depth_topic, kTransformType);
        if (of_color && of_depth)
            return ros_transform(*of_color, where(bag, connection.topic)) *
                   ros_transform(*of_depth, where(bag, depth_topic)).inverse();
    }
    return std::nullopt;
}

/// The way from the colour frame to the depth frame over the transforms of the bag, the shortest one.
std::optional<Eigen::Isometry3d> tf_motion(const MessageBag& bag, const BagTopics& topics) {
    const std::string &color = topics.color.kind.frame_id, &depth = topics.depth.kind.frame_id;
    if (color.empty() || depth.empty()) return std::nullopt;
    std::multimap<std::string, std::pair<std::string, Eigen::Isometry3d>> ways;  // from a frame to another
    for (const auto& [number, connection] : bag.connections()) {
        if (connection.type != kTransformsType && connection.type != kOldTransformsType) continue;
        std::size_t taken = 0;
        for (const MessageBag::Message& message : bag.messages({connection.topic})) {
            if (taken++ == kMostTransforms) break;
            try {
                for (const RosTransform& t : ros_transforms(bag.read(message), where(bag, connection.topic))) {
                    ways.emplace(t.parent, std::pair{t.child, t.T_parent_child});
                    ways.emplace(t.child, std::pair{t.parent, t.T_parent_child.inverse()});
                }
            } catch (const Error&) {
                continue;  // other topics may have it
            }
        }
    }
    std::map<std::string, Eigen::Isometry3d> T_color_frame{{color, Eigen::Isometry3d::Identity()}};
    std::deque<std::string> next{color};
    while (!next.empty() && !T_color_frame.contains(depth)) {
        const std::string frame = std::move(next.front());
        next.pop_front();
        for (auto [way, end] = ways.equal_range(frame); way != end; ++way) {
            const auto& [other, T_frame_other] = way->second;
            if (T_color_frame.try_emplace(other, T_color_frame.at(frame) * T_frame_other).second) next.push_back(other);
        }
    }
    const auto found = T_color_frame.find(depth);
    if (found == T_color_frame.end()) return std::nullopt;
    return found->second;
}

/// Depth as another camera measured it.
DepthCamera depth_camera(const MessageBag& bag, const BagTopics& topics, std::vector<std::string>& warnings) {
    const Camera& camera = topics.depth.camera->camera;
    DepthCamera depth{camera.intrinsics, camera.distortion, Eigen::Isometry3f::Identity()};
    auto motion = realsense_motion(bag, topics);
    if (!motion) motion = tf_motion(bag, topics);
    if (motion && motion->translation().norm() > kMaxBaseline) motion.reset();
    if (motion) depth.T_color_depth = motion->cast<float>();
    warnings.push_back(where(bag, topics.depth.name) + ": depth is not registered to colour; it is registered by " +
                       topics.depth.camera_topic +
                       (motion ? " and the transform between the cameras"
                               : ", as if both cameras were at one place (no transform between them is in the bag; "
                                 "--camera FILE may give T_color_depth)"));
    return depth;
}

/// RealSense's viewer writes how many metres a unit of depth is.
std::optional<float> realsense_depth_scale(const MessageBag& bag, const BagTopics& topics) {
    const std::size_t stream = topics.depth.name.find("/Depth_");
    if (stream == std::string::npos) return std::nullopt;
    for (const char* name : {"/option/Depth_Units/value", "/option/Depth Units/value"}) {
        const std::string topic = topics.depth.name.substr(0, stream) + name;
        const auto message = first_message(bag, topic, kFloatType);
        if (!message) continue;
        const float metres = ros_float(*message, where(bag, topic));
        if (metres > 0 && std::isfinite(1 / metres)) return 1 / metres;
    }
    return std::nullopt;
}

bool is_float(const std::string& encoding) { return encoding == "32FC1"; }

}  // namespace

BagCamera find_bag_camera(const MessageBag& bag, const BagTopics& topics, const SourceOptions& options,
                          std::vector<std::string>& warnings) {
    const BagTopic &color = topics.color, &depth = topics.depth;
    CameraDescription description;
    if (!options.camera_file.empty()) {
        description = read_camera_description(options.camera_file);
        if (description.camera.intrinsics.width == 0) {
            description.camera.intrinsics.width = color.kind.size.width;
            description.camera.intrinsics.height = color.kind.size.height;
        }
    } else if (color.camera) {
        description.camera = color.camera->camera;
        if (!color.camera->warning.empty()) warnings.push_back(color.camera->warning);
        const Intrinsics& K = description.camera.intrinsics;
        if (color.kind.size.width > 0 && !(color.kind.size == ImageSize{K.width, K.height}))
            throw Error(where(bag, color.camera_topic) + ": is for images of " + size_text({K.width, K.height}) +
                        ", those of " + color.name + " are " + size_text(color.kind.size) +
                        "; give the camera with --camera FILE");
    } else if (!color.camera_fault.empty()) {
        throw Error(color.camera_fault);
    } else {
        throw Error(bag.name() + ": holds no camera_info beside " + color.name +
                    "; give the camera with --camera FILE");
    }

    BagCamera found;
    if (is_float(depth.kind.encoding)) {
        if (description.says_depth_scale && description.camera.depth_scale != 1 &&
            description.camera.depth_scale != kFloatDepthScale)
            warnings.push_back(where(bag, depth.name) +
                               ": depth is in floating point and in metres; depth_scale of the camera file counts for "
                               "nothing");
        description.camera.depth_scale = kFloatDepthScale;
    } else if (!description.says_depth_scale) {
        constexpr float kMillimetres = 1000.0f;  // REP 118
        description.camera.depth_scale = realsense_depth_scale(bag, topics).value_or(kMillimetres);
    }
    std::optional<ImageSize> depth_size;
    if (depth.kind.size.width > 0) depth_size = depth.kind.size;
    const bool camera_fits =
        depth.camera && depth_size &&
        *depth_size == ImageSize{depth.camera->camera.intrinsics.width, depth.camera->camera.intrinsics.height};
    if (!description.depth && !topics.registered && camera_fits)
        description.depth = depth_camera(bag, topics, warnings);
    found.registration = registration_for(description, depth_size, bag.name(), warnings);
    found.camera = description.camera;
    return found;
}

}  // namespace posefusion
