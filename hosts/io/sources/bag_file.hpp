#pragma once
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "hosts/io/input_file.hpp"

/// Messages of ROS 1 bags, format 2.0 (http://wiki.ros.org/Bags/Format/2.0): chunks stored plain, bz2 or lz4.
///
/// Own code although there is a library: rosbag_storage trusts the lengths and offsets in a file (of 300 bags with one
/// byte changed, two made it read beyond its buffers), and a recording may come from anywhere. The index of a bag is
/// only a hint: a bag without one (recording was interrupted) is read as well.
namespace posefusion {

class BagFile {
public:
    struct Connection {
        std::string topic;
        std::string type;  ///< "sensor_msgs/Image", ...
    };
    /// Position of a message: byte `offset` of the unpacked chunk.
    struct Message {
        std::uint32_t connection = 0;
        std::uint32_t chunk = 0;
        std::uint32_t offset = 0;
        std::uint64_t recorded = 0;  ///< nanoseconds
    };

    /// Reads the index, or the chunks if there is none. Throws Error: not a bag, another version, empty.
    explicit BagFile(const std::filesystem::path& file);

    [[nodiscard]] const std::string& name() const { return file_.name(); }
    [[nodiscard]] const std::map<std::uint32_t, Connection>& connections() const { return connections_; }
    /// Messages of these topics, in the order they were recorded.
    [[nodiscard]] std::vector<Message> messages(const std::vector<std::string>& topics) const;

    /// The serialised message; at most its first `at_most` bytes, which saves time with uncompressed chunks. May be
    /// called from several threads. Throws Error when the bag is damaged there.
    [[nodiscard]] ByteBuffer read(const Message& message, std::size_t at_most = SIZE_MAX) const;

    /// Problems that do not prevent the use, one line each.
    [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

private:
    enum class Packing { Plain, Bz2, Lz4 };
    struct Chunk {
        std::uint64_t offset = 0;  ///< of its data, in the file
        std::uint32_t packed_bytes = 0, bytes = 0;
        Packing packing = Packing::Plain;
        bool indexed = false;
    };
    using Fields = std::map<std::string, ByteBuffer>;
    using SharedBytes = std::shared_ptr<const ByteBuffer>;

    [[nodiscard]] Fields parse_fields(ByteView header) const;
    template <class Number>
    [[nodiscard]] Number field(const Fields& fields, const char* key) const;
    [[nodiscard]] ByteBuffer read_at(const Chunk& chunk, std::uint32_t offset, std::size_t count) const;

    void walk_file();
    void add_chunk(const Fields& fields, std::uint64_t offset, std::uint32_t bytes);
    void add_index(const Fields& fields, const ByteBuffer& data);
    void add_connection(const Fields& fields, ByteView data);
    void walk_chunk(std::uint32_t chunk);
    [[nodiscard]] ByteBuffer unpack(const Chunk& chunk) const;
    [[nodiscard]] SharedBytes unpacked(std::uint32_t chunk) const;

    InputFile file_;
    std::map<std::uint32_t, Connection> connections_;
    std::vector<Chunk> chunks_;
    std::vector<Message> messages_;
    std::vector<std::string> warnings_;
    mutable std::mutex mutex_;
    mutable std::deque<std::pair<std::uint32_t, SharedBytes>> unpacked_;  ///< the chunks used last
};

}  // namespace posefusion
