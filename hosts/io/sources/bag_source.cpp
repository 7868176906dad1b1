#include "hosts/io/sources/bag_source.hpp"

#include <algorithm>
#include <utility>

#include "hosts/io/association.hpp"
#include "hosts/io/sources/bag_camera.hpp"
#include "hosts/io/sources/bag_file.hpp"
#include "hosts/io/sources/bag_topics.hpp"
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

class BagSource final : public FrameSource {
public:
    BagSource(const fs::path& file, const SourceOptions& options) : bag_(file) {
        facts_.location = file.string();
        facts_.name = file.stem().string();
        facts_.warnings = bag_.warnings();
        const BagTopics topics = choose_topics(bag_, options);
        facts_.warnings.insert(facts_.warnings.end(), topics.warnings.begin(), topics.warnings.end());
        color_ = {topics.color.name, topics.color.compressed};
        depth_ = {topics.depth.name, topics.depth.compressed};
        pair(stamped(color_), stamped(depth_));
        BagCamera camera = find_bag_camera(bag_, topics, options, facts_.warnings);
        facts_.camera = camera.camera;
        registration_ = std::move(camera.registration);
    }

    [[nodiscard]] RawFrame read(std::size_t i) const override {
        const FrameEntry& entry = facts_.frames.at(i);
        const Pair& pair = pairs_[i];
        const Intrinsics& K = facts_.camera.intrinsics;
        const std::string where = bag_.name() + ", " + entry.stamp_text + ", ";
        RawFrame frame{entry.stamp, entry.stamp_text, {}, {}, where + color_.topic, where + depth_.topic};
        frame.color = ros_color(bag_.read(pair.color), color_.compressed, frame.color_name, {K.width, K.height});
        const ImageSize depth_size = registration_ ? registration_->depth_size() : ImageSize{K.width, K.height};
        frame.depth = ros_depth(bag_.read(pair.depth), depth_.compressed, frame.depth_name, depth_size);
        if (registration_) frame.depth = registration_->apply(frame.depth, facts_.camera.depth_scale);
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

    BagFile bag_;
    Topic color_, depth_;
    std::vector<Pair> pairs_;
    std::optional<DepthRegistration> registration_;
};

}  // namespace

std::unique_ptr<FrameSource> open_bag(const fs::path& file, const SourceOptions& options) {
    return std::make_unique<BagSource>(file, options);
}

}  // namespace posefusion
