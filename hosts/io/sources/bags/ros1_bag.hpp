#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "hosts/io/input_file.hpp"
#include "hosts/io/sources/bags/chunk_store.hpp"
#include "hosts/io/sources/bags/message_bag.hpp"

/// ROS 1 bags, format 2.0 (http://wiki.ros.org/Bags/Format/2.0): chunks stored plain, bz2 or lz4.
///
/// Own code although there is a library: rosbag_storage trusts the lengths and offsets in a file (of 300 bags with one
/// byte changed, two made it read beyond its buffers), and a recording may come from anywhere. The index of a bag is
/// only a hint: a bag without one (recording was interrupted) is read as well.
namespace posefusion {

class Ros1Bag final : public MessageBag {
public:
    /// Reads the index, or the chunks if there is none. Throws Error: not a bag, another version, empty.
    explicit Ros1Bag(const std::filesystem::path& file);

private:
    using Fields = std::map<std::string, ByteBuffer>;

    [[nodiscard]] ByteBuffer read_bytes(const Message& message, std::size_t at_most) const override;
    [[nodiscard]] Fields parse_fields(ByteView header) const;
    template <class Number>
    [[nodiscard]] Number field(const Fields& fields, const char* key) const;

    void walk_file();
    void add_chunk(const Fields& fields, std::uint64_t offset, std::uint32_t bytes);
    void add_index(const Fields& fields, const ByteBuffer& data);
    void add_topic(const Fields& fields, ByteView data);
    void walk_chunk(std::uint32_t chunk);

    InputFile file_;
    ChunkStore chunks_;
    std::vector<bool> indexed_;  ///< of each chunk: its messages are known
};

}  // namespace posefusion
