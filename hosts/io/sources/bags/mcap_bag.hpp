#pragma once
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "hosts/io/input_file.hpp"
#include "hosts/io/sources/bags/chunk_store.hpp"
#include "hosts/io/sources/bags/message_bag.hpp"

/// MCAP files (https://mcap.dev/spec), with messages of ROS 2 or, converted, of ROS 1; chunks plain, lz4 or zstd.
///
/// The file is walked from record to record without unpacking what has an index, so that one that was not closed (no
/// summary, no footer, a record cut off) is read in the same way as any other. The summary at the end, if there is one,
/// is part of the walk: it repeats the topics.
namespace posefusion {

class McapBag final : public MessageBag {
public:
    /// @param name  of the recording, for messages
    /// Throws Error: not an MCAP file, damaged before the first message, no messages of ROS.
    McapBag(const std::filesystem::path& file, const std::string& name);
    explicit McapBag(const std::filesystem::path& file) : McapBag(file, file.string()) {}

private:
    struct Record {
        std::uint8_t kind = 0;
        std::uint64_t at = 0, bytes = 0;  ///< of its content, in the file
    };

    [[nodiscard]] ByteBuffer read_bytes(const Message& message, std::size_t at_most) const override;

    void walk_file();
    [[nodiscard]] Record record_at(std::uint64_t at) const;
    [[nodiscard]] ByteBuffer content(const Record& record) const;
    void visit(const Record& record);
    void add_schema(ByteView content);
    void add_channel(ByteView content);
    void add_chunk(const Record& record);
    void add_index(ByteView content);
    void walk_chunks();
    void walk_chunk(std::uint32_t chunk);
    [[nodiscard]] bool is_known(std::uint32_t chunk) const;

    InputFile file_;
    ChunkStore chunks_;
    /// For each chunk the channels in its index; empty = it has none.
    std::vector<std::vector<std::uint16_t>> indices_;
    std::map<std::uint16_t, std::string> schemas_;  ///< types of messages
    std::set<std::uint16_t> channels_;              ///< those described so far, of ROS or not
    std::string foreign_encoding_;                  ///< of a channel that is not of ROS; empty = none seen
};

}  // namespace posefusion
