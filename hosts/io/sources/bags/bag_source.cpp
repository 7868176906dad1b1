#include "hosts/io/sources/bags/bag_source.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "hosts/io/association.hpp"
#include "hosts/io/sources/bags/bag_camera.hpp"
#include "hosts/io/sources/bags/bag_topics.hpp"
#include "hosts/io/sources/bags/message_bag.hpp"
#include "hosts/io/sources/bags/ros_messages.hpp"
#include "hosts/io/sources/time_order.hpp"

namespace posefusion {
namespace {

struct StampedMessage {
    Stamp stamp{};
    MessageBag::Message message;
};

class BagSource final : public FrameSource {
public:
    BagSource(std::unique_ptr<MessageBag> bag, std::string name, const SourceOptions& options)
        : owner_(std::move(bag)), bag_(*owner_) {
        facts_.location = bag_.name();
        facts_.name = std::move(name);
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
        RawFrame frame{entry.stamp, entry.stamp_text,     entry.depth_delay,   {},
                       {},          where + color_.topic, where + depth_.topic};
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
        MessageBag::Message color, depth;
    };

    [[nodiscard]] std::string name_of(const Topic& topic) const { return bag_.name() + ", " + topic.topic; }

    /// Messages of a topic with the stamps of their headers, in the order of recording.
    [[nodiscard]] std::vector<StampedMessage> stamped(const Topic& topic) {
        std::vector<StampedMessage> all;
        std::size_t bad = 0;
        std::string fault;
        for (const MessageBag::Message& message : bag_.messages({topic.topic})) {
            try {
                all.push_back({ros_stamp(bag_.read(message, kStampedBytes), name_of(topic)), message});
            } catch (const Error& error) {
                if (bad++ == 0) fault = error.what();
            }
        }
        if (all.empty())
            throw Error(name_of(topic) + (bad == 0 ? ": no messages" : ": no message can be read: " + fault));
        if (bad > 0) facts_.warnings.push_back(fault + " (" + count_text(bad, "message") + " left out)");
        return all;
    }

    /// Uses the stamps of the headers, which say when the images were taken, unless they are unset.
    void pair(std::vector<StampedMessage> color, std::vector<StampedMessage> depth) {
        std::string fault;
        for (const auto& [topic, messages] : {std::pair{&color_, &color}, std::pair{&depth_, &depth}})
            if (say_nothing(stamps_of(*messages))) fault = "the header stamps of " + topic->topic + " are all alike";
        if (fault.empty() && associate(stamps_of(color), stamps_of(depth)).empty())
            fault = "no header stamp of " + color_.topic + " is within 20 ms of one of " + depth_.topic;
        if (!fault.empty()) {
            for (auto* messages : {&color, &depth})
                for (StampedMessage& m : *messages) m.stamp = Stamp{static_cast<std::int64_t>(m.message.recorded)};
            facts_.warnings.push_back(bag_.name() + ": " + fault + "; the times of recording are used instead");
        }
        leave_out_unset(color, color_);
        leave_out_unset(depth, depth_);
        put_in_order(color, name_of(color_), "message", facts_.warnings);
        put_in_order(depth, name_of(depth_), "message", facts_.warnings);
        for (const auto& [c, d] : associate(stamps_of(color), stamps_of(depth))) {
            facts_.frames.push_back(entry_at(color[c].stamp, depth[d].stamp));
            pairs_.push_back({color[c].message, depth[d].message});
        }
        if (pairs_.empty())
            throw Error(bag_.name() + ": no image of " + color_.topic + " has one of " + depth_.topic +
                        " within 20 ms");
        if (pairs_.size() < color.size())
            facts_.warnings.push_back(bag_.name() + ": " + count_text(color.size() - pairs_.size(), "colour image") +
                                      " without a depth image within 20 ms left out");
    }

    /// A single stamp of 0 was left out by the driver. (A simulation starts at 0: then other stamps are near.)
    void leave_out_unset(std::vector<StampedMessage>& messages, const Topic& topic) {
        constexpr Stamp kStartOfSimulation = std::chrono::minutes(1);
        const auto is_set = [](const StampedMessage& m) { return m.stamp != Stamp{0}; };
        const auto earliest = std::min_element(messages.begin(), messages.end(), [&](const auto& a, const auto& b) {
            return is_set(a) != is_set(b) ? is_set(a) : a.stamp < b.stamp;
        });
        if (earliest->stamp < kStartOfSimulation) return;
        const auto unset = std::erase_if(messages, std::not_fn(is_set));
        if (unset > 0)
            facts_.warnings.push_back(name_of(topic) + ": " + count_text(unset, "message") +
                                      " without a time stamp left out");
    }

    std::unique_ptr<MessageBag> owner_;
    const MessageBag& bag_;
    Topic color_, depth_;
    std::vector<Pair> pairs_;
    std::optional<DepthRegistration> registration_;
};

}  // namespace

std::unique_ptr<FrameSource> frames_of_bag(std::unique_ptr<MessageBag> bag, std::string name,
                                           const SourceOptions& options) {
    return std::make_unique<BagSource>(std::move(bag), std::move(name), options);
}

}  // namespace posefusion
