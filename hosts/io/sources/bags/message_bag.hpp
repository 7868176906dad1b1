#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "hosts/io/sources/bags/ros_reader.hpp"

/// Recorded messages of ROS, whatever file they are in.
namespace posefusion {

class MessageBag {
public:
    struct Connection {
        std::string topic;
        std::string type;  ///< as ROS 1 writes it: "sensor_msgs/Image", not "sensor_msgs/msg/Image"
        RosEncoding encoding = RosEncoding::Ros1;
    };
    struct Message {
        std::uint32_t connection = 0;
        std::uint32_t part = 0;      ///< chunk or file, and ...
        std::uint64_t place = 0;     ///< ... the place in it; each kind of bag has its own meaning
        std::uint64_t recorded = 0;  ///< nanoseconds
    };

    virtual ~MessageBag() = default;
    MessageBag(const MessageBag&) = delete;
    MessageBag& operator=(const MessageBag&) = delete;

    [[nodiscard]] const std::string& name() const { return name_; }
    [[nodiscard]] const std::map<std::uint32_t, Connection>& connections() const { return connections_; }
    /// In the order they were recorded, all or those of some topics.
    [[nodiscard]] const std::vector<Message>& messages() const { return messages_; }
    [[nodiscard]] std::vector<Message> messages(const std::vector<std::string>& topics) const;

    /// The serialised message, unpacked where it was packed on its own (rosbag2's `compression_mode: message`); at most
    /// its first `at_most` bytes, which saves time. May be called from several threads. Throws Error when the bag is
    /// damaged there.
    [[nodiscard]] RosMessage read(const Message& message, std::size_t at_most = SIZE_MAX) const;

    /// Problems that do not prevent the use, one line each.
    [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

protected:
    /// @param name  of the bag, for messages
    explicit MessageBag(std::string name) : name_(std::move(name)) {}

    [[nodiscard]] virtual ByteBuffer read_bytes(const Message& message, std::size_t at_most) const = 0;

    // For the constructors of the kinds of bags. The first two throw Error when there are too many.
    void add_connection(std::uint32_t number, Connection connection);  ///< or replaces it
    void add_message(const Message& message);
    void drop_messages(std::uint32_t part);  ///< those of a chunk or file
    void add_warning(std::string line) { warnings_.push_back(std::move(line)); }
    void finish();  ///< puts the messages in order; throws Error if there is none

private:
    std::string name_;
    std::map<std::uint32_t, Connection> connections_;
    std::vector<Message> messages_;
    std::vector<std::string> warnings_;
};

}  // namespace posefusion
