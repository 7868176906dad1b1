#include "hosts/io/sources/bags/mcap_bag.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

#include "engine/core/error.hpp"
#include "hosts/io/sources/bags/ros2_names.hpp"

namespace posefusion {
namespace {

constexpr std::array<std::uint8_t, 8> kMagic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
constexpr std::size_t kRecordHeadBytes = sizeof(std::uint8_t) + sizeof(std::uint64_t);
/// Of a message before its data: channel, sequence number, times of recording and of publishing.
constexpr std::size_t kMessageHeadBytes = 2 + 4 + 8 + 8;
/// Of a chunk before the name of its packing: times of its messages, size, checksum.
constexpr std::size_t kChunkHeadBytes = 8 + 8 + 8 + 4;
/// Largest record that is read in one go: topics, types with the text of their definitions, indices.
constexpr std::uint64_t kMaxRecordBytes = std::uint64_t{1} << 26;
constexpr std::size_t kMaxSchemas = 1U << 16;
constexpr std::uint32_t kMaxName = 16;
/// `part` of messages that are in no chunk: their place is that in the file.
constexpr std::uint32_t kNoChunk = std::numeric_limits<std::uint32_t>::max();

enum Kind : std::uint8_t { kFooter = 2, kSchema = 3, kChannel = 4, kMessage = 5, kChunk = 6, kMessageIndex = 7 };

struct MessageHead {
    std::uint16_t channel;
    std::uint64_t recorded;
};
MessageHead parse_message(ByteView content, const std::string& name) {
    ByteReader reader(content, name);
    const auto channel = reader.take<std::uint16_t>();
    (void)reader.take<std::uint32_t>();
    return {channel, reader.take<std::uint64_t>()};
}

Packing packing_called(const std::string& packing, const std::string& name) {
    if (packing.empty() || packing == "none") return Packing::Plain;
    if (packing == "lz4") return Packing::Lz4;
    if (packing == "zstd") return Packing::Zstd;
    throw Error(name + ": its chunks are packed in a way that is not known ('" + packing + "')");
}

}  // namespace

McapBag::McapBag(const std::filesystem::path& file, const std::string& name)
    : MessageBag(name), file_(file, name), chunks_(file_) {
    const ByteBuffer head = file_.read(0, std::min<std::size_t>(kMagic.size(), file_.size()));
    if (!std::equal(kMagic.begin(), kMagic.end(), head.begin(), head.end()))
        throw Error(name + ": is not an MCAP file (version 0)");
    walk_file();
    walk_chunks();
    if (connections().empty() && !foreign_encoding_.empty())
        throw Error(name + ": its messages are of encoding '" + foreign_encoding_ +
                    "'; those of ROS can be read (cdr, ros1)");
    finish();
}

McapBag::Record McapBag::record_at(std::uint64_t at) const {
    const ByteBuffer head = file_.read(at, kRecordHeadBytes);
    ByteReader reader(head, name());
    Record record{reader.take<std::uint8_t>(), at + kRecordHeadBytes, reader.take<std::uint64_t>()};
    if (record.bytes > file_.size() - record.at) throw Error(name() + ": ends early");
    return record;
}

ByteBuffer McapBag::content(const Record& record) const {
    if (record.bytes > kMaxRecordBytes) throw Error(name() + ": is damaged: a record without end");
    return file_.read(record.at, static_cast<std::size_t>(record.bytes));
}

/// Visits all records of the file without unpacking chunks.
void McapBag::walk_file() {
    std::uint64_t at = kMagic.size();
    bool closed = false;
    try {
        while (at < file_.size() && !closed) {
            const Record record = record_at(at);
            at = record.at + record.bytes;
            closed = record.kind == kFooter;
            visit(record);
        }
        if (!closed) throw Error(name() + ": was not closed, as when its recording was interrupted");
    } catch (const Error& error) {
        if (chunks_.size() == 0 && messages().empty()) throw;
        add_warning(std::string(error.what()) + "; what comes before is used");
        // Its index may be cut off, too: there is one per topic.
        if (chunks_.size() == 0) return;
        drop_messages(chunks_.size() - 1);
        indices_.back().clear();
    }
}

void McapBag::visit(const Record& record) {
    switch (record.kind) {
        case kSchema:
            return add_schema(content(record));
        case kChannel:
            return add_channel(content(record));
        case kChunk:
            return add_chunk(record);
        case kMessageIndex:
            return add_index(content(record));
        case kMessage: {
            const ByteBuffer bytes = file_.read(record.at, std::min<std::uint64_t>(record.bytes, kMessageHeadBytes));
            const MessageHead head = parse_message(bytes, name());
            return add_message({head.channel, kNoChunk, record.at - kRecordHeadBytes, head.recorded});
        }
        default:
            return;  // statistics, attachments and what else there is add nothing
    }
}

void McapBag::add_schema(ByteView content) {
    ByteReader reader(content, name());
    const auto number = reader.take<std::uint16_t>();
    if (schemas_.size() == kMaxSchemas) throw Error(name() + ": holds too many types");
    schemas_[number] = reader.take_text();
}

void McapBag::add_channel(ByteView content) {
    ByteReader reader(content, name());
    const auto number = reader.take<std::uint16_t>();
    const auto schema = schemas_.find(reader.take<std::uint16_t>());
    std::string topic = reader.take_text();
    const std::string encoding = reader.take_text();
    const bool known = encoding == "cdr" || encoding == "ros1";
    channels_.insert(number);
    if (!known) foreign_encoding_ = encoding.substr(0, kMaxName);
    if (!known || schema == schemas_.end()) return;
    add_connection(number, {std::move(topic), short_type(schema->second),
                            encoding == "cdr" ? RosEncoding::Cdr : RosEncoding::Ros1});
}

void McapBag::add_chunk(const Record& record) {
    const auto most = static_cast<std::size_t>(
        std::min<std::uint64_t>(record.bytes, kChunkHeadBytes + sizeof(std::uint32_t) + kMaxName + 8));
    const ByteBuffer head = file_.read(record.at, most);
    ByteReader reader(head, name());
    (void)reader.take(2 * sizeof(std::uint64_t));  // times of its messages
    ChunkStore::Chunk chunk;
    chunk.bytes = reader.take<std::uint64_t>();
    chunk.crc = reader.take<std::uint32_t>();
    chunk.packing = packing_called(reader.take_text(), name());
    chunk.packed_bytes = reader.take<std::uint64_t>();
    const std::uint64_t head_bytes = head.size() - reader.left();
    if (chunk.packed_bytes > record.bytes - head_bytes)
        throw Error(name() + ": is damaged: a chunk ends within its messages");
    if (chunk.packing == Packing::Plain) chunk.bytes = chunk.packed_bytes;
    chunk.offset = record.at + head_bytes;
    chunks_.add(chunk);
    indices_.emplace_back();
}

/// Of the chunk before it: the times and places of the messages of one channel.
void McapBag::add_index(ByteView content) {
    if (chunks_.size() == 0) return;
    ByteReader reader(content, name());
    const auto channel = reader.take<std::uint16_t>();
    ByteReader entries(reader.take_block(), name());
    while (!entries.at_end()) {
        const auto recorded = entries.take<std::uint64_t>();
        add_message({channel, chunks_.size() - 1, entries.take<std::uint64_t>(), recorded});
    }
    indices_.back().push_back(channel);
}

/// Whether index and topics of a chunk are known without unpacking it.
bool McapBag::is_known(std::uint32_t chunk) const {
    const auto& channels = indices_[chunk];
    return !channels.empty() && std::all_of(channels.begin(), channels.end(),
                                            [&](std::uint16_t channel) { return channels_.contains(channel); });
}

/// Of chunks without an index, and of those that alone tell what their topics are.
void McapBag::walk_chunks() {
    std::size_t bad_chunks = 0;
    std::string first_fault;
    for (std::uint32_t i = 0; i < chunks_.size(); ++i) {
        if (is_known(i)) continue;
        try {
            walk_chunk(i);
        } catch (const Error& error) {
            if (bad_chunks++ == 0) first_fault = error.what();
        }
    }
    if (bad_chunks == 0) return;
    if (messages().empty() || connections().empty()) throw Error(first_fault);
    add_warning(first_fault + " (" + std::to_string(bad_chunks) + " of " + std::to_string(chunks_.size()) +
                " chunks are damaged)");
}

/// Reads the records inside the chunk.
void McapBag::walk_chunk(std::uint32_t number) {
    const bool messages_known = !indices_[number].empty();
    const SharedBytes bytes = chunks_.unpacked(number);
    ByteReader reader(*bytes, name());
    while (!reader.at_end()) {
        const std::uint64_t at = bytes->size() - reader.left();
        const auto kind = reader.take<std::uint8_t>();
        const auto length = reader.take<std::uint64_t>();
        const ByteView content = reader.take(static_cast<std::size_t>(length));
        if (kind == kSchema) add_schema(content);
        if (kind == kChannel) add_channel(content);
        if (kind != kMessage || messages_known) continue;
        const MessageHead head = parse_message(content, name());
        add_message({head.channel, number, at, head.recorded});
    }
}

ByteBuffer McapBag::read_bytes(const Message& message, std::size_t at_most) const {
    const auto read = [&](std::uint64_t at, std::size_t count) {
        return message.part == kNoChunk ? file_.read(at, count) : chunks_.read(message.part, at, count);
    };
    const ByteBuffer head = read(message.place, kRecordHeadBytes);
    ByteReader reader(head, name());
    if (reader.take<std::uint8_t>() != kMessage)
        throw Error(name() + ": is damaged: the index points at something that is no message");
    const auto length = reader.take<std::uint64_t>();
    if (length < kMessageHeadBytes) throw Error(name() + ": is damaged: a message ends within its head");
    const std::uint64_t bytes = length - kMessageHeadBytes;
    if (bytes > kMaxChunkBytes && at_most > kMaxChunkBytes) throw Error(name() + ": is damaged: a message without end");
    return read(message.place + kRecordHeadBytes + kMessageHeadBytes,
                static_cast<std::size_t>(std::min<std::uint64_t>(bytes, at_most)));
}

}  // namespace posefusion
