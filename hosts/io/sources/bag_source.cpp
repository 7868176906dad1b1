#include "hosts/io/sources/bag_source.hpp"

#include <algorithm>
#include <array>
#include <string_view>

#include "hosts/io/association.hpp"
#include "hosts/io/sources/bag_file.hpp"
#include "hosts/io/sources/ros_messages.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

/// A message whose header stamp has been read.
struct StampedMessage {
    RosStamp stamp;
    double seconds = 0;
    BagFile::Message message;
};

bool contains(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

bool is_image_type(const std::string& type) { return type == kImageType || type == kCompressedImageType; }

bool names_depth(const std::string& topic) { return contains(topic, "depth"); }

/// How likely the topic holds what is looked for; 0 = not at all.
int color_score(const BagFile::Connection& c) {
    if (!is_image_type(c.type) || names_depth(c.topic) || contains(c.topic, "theora")) return 0;
    int score = 1;
    for (const std::string_view word : {"rgb", "color", "colour"}) score += contains(c.topic, word) ? 4 : 0;
    if (contains(c.topic, "rect")) score += 2;
    if (c.type == kImageType) score += 1;
    if (contains(c.topic, "mono") || contains(c.topic, "/ir")) score = 1;
    return score;
}

int depth_score(const BagFile::Connection& c) {
    if (!is_image_type(c.type) || !names_depth(c.topic)) return 0;
    int score = 1;
    for (const std::string_view word : {"registered", "aligned", "rect"}) score += contains(c.topic, word) ? 2 : 0;
    if (c.type == kImageType) score += 1;
    return score;
}

class BagSource final : public FrameSource {
public:
    BagSource(const fs::path& file, const SourceOptions& options) : bag_(file) {
        facts_.location = file.string();
        facts_.name = file.stem().string();
        facts_.warnings = bag_.warnings();
        color_ = find_topic("colour", "--color-topic", options.color_topic, color_score);
        depth_ = find_topic("depth", "--depth-topic", options.depth_topic, depth_score);
        pair(stamped(color_), stamped(depth_));
        facts_.camera = find_camera(options);
    }

    [[nodiscard]] RawFrame read(std::size_t i) const override {
        const FrameEntry& entry = facts_.frames.at(i);
        const Pair& pair = pairs_[i];
        const Intrinsics& K = facts_.camera.intrinsics;
        const std::string where = bag_.name() + ", " + entry.stamp_text + ", ";
        RawFrame frame{entry.stamp, entry.stamp_text, {}, {}, where + color_.topic, where + depth_.topic};
        frame.color = ros_color(bag_.read(pair.color), color_.compressed, frame.color_name, {K.width, K.height});
        frame.depth = ros_depth(bag_.read(pair.depth), depth_.compressed, frame.depth_name, {K.width, K.height});
        return frame;
    }

private:
    struct Topic {
        std::string topic;
        bool compressed = false;
    };
    struct Pair {
        BagFile::Message color, depth;
    };

    [[nodiscard]] std::string name_of(const Topic& topic) const { return bag_.name() + ", " + topic.topic; }

    template <class Score>
    Topic find_topic(const char* what, const char* option, const std::string& given, Score score) {
        std::map<std::string, std::pair<int, bool>> candidates;  // by topic: likelihood, compressed
        for (const auto& [number, connection] : bag_.connections()) {
            const int likely = given.empty() ? score(connection) : static_cast<int>(connection.topic == given);
            if (likely > 0 && is_image_type(connection.type))
                candidates[connection.topic] = {likely, connection.type == kCompressedImageType};
        }
        if (candidates.empty() && !given.empty())
            throw Error(bag_.name() + ": has no image topic " + given + "; it has " + image_topics());
        if (candidates.empty())
            throw Error(bag_.name() + ": has no " + what + " images (its image topics: " + image_topics() +
                        "); name one with " + option);
        const auto best = std::max_element(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
            return a.second.first < b.second.first;
        });
        if (candidates.size() > 1)
            facts_.warnings.push_back(bag_.name() + ": " + std::to_string(candidates.size()) + " topics may hold " +
                                      what + " images; " + best->first + " is used (" + option + " names another)");
        return {best->first, best->second.second};
    }

    [[nodiscard]] std::string image_topics() const {
        std::string all;
        for (const auto& [number, connection] : bag_.connections())
            if (is_image_type(connection.type) && !contains(all, connection.topic))
                all += (all.empty() ? "" : ", ") + connection.topic;
        return all.empty() ? "none" : all;
    }

    /// Messages of a topic in the order of their header stamps, each stamp once.
    [[nodiscard]] std::vector<StampedMessage> stamped(const Topic& topic) {
        std::vector<StampedMessage> all;
        std::size_t bad = 0;
        std::string fault;
        for (const BagFile::Message& message : bag_.messages({topic.topic})) {
            try {
                const RosStamp stamp = ros_stamp(bag_.read(message, kStampedBytes), name_of(topic));
                all.push_back({stamp, stamp.value(), message});
            } catch (const Error& error) {
                if (bad++ == 0) fault = error.what();
            }
        }
        if (all.empty())
            throw Error(name_of(topic) + (bad == 0 ? ": no messages" : ": no message can be read: " + fault));
        if (bad > 0) facts_.warnings.push_back(fault + " (" + std::to_string(bad) + " messages left out)");
        const auto earlier = [](const StampedMessage& a, const StampedMessage& b) { return a.seconds < b.seconds; };
        std::stable_sort(all.begin(), all.end(), earlier);
        all.erase(std::unique(all.begin(), all.end(),
                              [](const StampedMessage& a, const StampedMessage& b) { return a.seconds == b.seconds; }),
                  all.end());
        return all;
    }

    void pair(const std::vector<StampedMessage>& color, const std::vector<StampedMessage>& depth) {
        const auto seconds = [](const std::vector<StampedMessage>& messages) {
            std::vector<double> all;
            for (const StampedMessage& m : messages) all.push_back(m.seconds);
            return all;
        };
        for (const auto& [c, d] : associate(seconds(color), seconds(depth))) {
            facts_.frames.push_back({color[c].seconds, color[c].stamp.text()});
            pairs_.push_back({color[c].message, depth[d].message});
        }
        if (pairs_.empty())
            throw Error(bag_.name() + ": no image of " + color_.topic + " has one of " + depth_.topic +
                        " within 20 ms");
        if (pairs_.size() < color.size())
            facts_.warnings.push_back(bag_.name() + ": " + std::to_string(color.size() - pairs_.size()) +
                                      " colour images without a depth image within 20 ms left out");
    }

    Camera find_camera(const SourceOptions& options) {
        const float scale = ros_depth_scale(bag_.read(pairs_.front().depth), depth_.compressed, name_of(depth_));
        if (!options.camera_file.empty()) return read_camera_file(options.camera_file, scale);
        Topic info;
        std::string folder = color_.topic;
        // /camera/rgb/image_color/compressed belongs to /camera/rgb/camera_info
        while (info.topic.empty() && contains(folder, "/")) {
            folder.erase(folder.rfind('/'));
            for (const auto& [number, connection] : bag_.connections())
                if (connection.type == kCameraInfoType && connection.topic == folder + "/camera_info")
                    info.topic = connection.topic;
        }
        const auto messages = info.topic.empty() ? std::vector<BagFile::Message>{} : bag_.messages({info.topic});
        if (messages.empty())
            throw Error(bag_.name() + ": holds no camera_info beside " + color_.topic +
                        "; give the camera with --camera FILE");
        std::string warning;
        Camera camera = ros_camera(bag_.read(messages.front()), contains(color_.topic, "rect"), name_of(info), warning);
        if (!warning.empty()) facts_.warnings.push_back(warning);
        const ImageSize size = ros_image_size(bag_.read(pairs_.front().color), color_.compressed, name_of(color_));
        if (!(size == ImageSize{camera.intrinsics.width, camera.intrinsics.height}))
            throw Error(name_of(info) + ": is for images of another size; give the camera with --camera FILE");
        camera.depth_scale = scale;
        return camera;
    }

    BagFile bag_;
    Topic color_, depth_;
    std::vector<Pair> pairs_;
};

}  // namespace

std::unique_ptr<FrameSource> open_bag(const fs::path& file, const SourceOptions& options) {
    return std::make_unique<BagSource>(file, options);
}

}  // namespace posefusion
