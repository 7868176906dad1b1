#include "hosts/io/sources/bags/ros1_bag.hpp"

#include <algorithm>
#include <string_view>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
/// Largest header of a record; real ones have some 100 bytes.
constexpr std::uint32_t kMaxHeaderBytes = 1U << 20;
/// Largest connection description (the text of the message definition is part of it).
constexpr std::uint32_t kMaxConnectionBytes = 1U << 24;
constexpr std::uint64_t kNanoseconds = 1'000'000'000;
constexpr std::size_t kLengthBytes = sizeof(std::uint32_t);

enum Op : std::uint8_t { kMessage = 2, kBagHeader = 3, kIndex = 4, kChunk = 5, kChunkInfo = 6, kConnection = 7 };

std::uint64_t nanoseconds(std::uint64_t time) { return (time & 0xFFFFFFFF) * kNanoseconds + (time >> 32); }

}  // namespace

Ros1Bag::Ros1Bag(const std::filesystem::path& file) : MessageBag(file.string()), file_(file), chunks_(file_) {
    if (file_.size() < kMagic.size()) throw Error(name() + ": is not a ROS bag");
    const ByteBuffer head = file_.read(0, kMagic.size());
    const std::string start(head.begin(), head.end());
    if (start != kMagic)
        throw Error(name() + (start.starts_with("#ROSBAG V")
                                  ? ": is a bag of another version than 2.0; convert it with "
                                    "`rosbag fix`"
                                  : ": is not a ROS bag"));
    walk_file();
    const bool topics_known = !connections().empty();
    std::size_t bad_chunks = 0;
    std::string first_fault;
    for (std::uint32_t i = 0; i < chunks_.size(); ++i) {
        if (topics_known && indexed_[i]) continue;
        try {
            walk_chunk(i);
        } catch (const Error& error) {
            if (bad_chunks++ == 0) first_fault = error.what();
        }
    }
    if (connections().empty() && bad_chunks > 0) throw Error(first_fault);
    if (bad_chunks > 0)
        add_warning(first_fault + " (" + std::to_string(bad_chunks) + " of " + std::to_string(chunks_.size()) +
                    " chunks are damaged)");
    finish();
}

Ros1Bag::Fields Ros1Bag::parse_fields(ByteView header) const {
    Fields fields;
    ByteReader reader(header, name());
    while (!reader.at_end()) {
        const auto block = reader.take_block();
        const auto equals = std::find(block.begin(), block.end(), static_cast<std::uint8_t>('='));
        if (equals == block.end()) throw Error(name() + ": is damaged: a record has no valid header");
        fields[std::string(block.begin(), equals)] = ByteBuffer(equals + 1, block.end());
    }
    return fields;
}

template <class Number>
Number Ros1Bag::field(const Fields& fields, const char* key) const {
    const auto found = fields.find(key);
    if (found == fields.end() || found->second.size() != sizeof(Number))
        throw Error(name() + ": is damaged: a record lacks '" + key + "'");
    return ByteReader(found->second, name()).take<Number>();
}

/// Visits all records of the file without unpacking chunks.
void Ros1Bag::walk_file() {
    std::uint64_t at = kMagic.size();
    try {
        while (at < file_.size()) {
            const auto header_bytes = ByteReader(file_.read(at, kLengthBytes), name()).take<std::uint32_t>();
            if (header_bytes > kMaxHeaderBytes) throw Error(name() + ": is damaged: a record header has no end");
            const Fields fields = parse_fields(file_.read(at + kLengthBytes, header_bytes));
            at += kLengthBytes + header_bytes;
            const auto data_bytes = ByteReader(file_.read(at, kLengthBytes), name()).take<std::uint32_t>();
            at += kLengthBytes;
            if (data_bytes > file_.size() - at) throw Error(name() + ": ends early");
            switch (field<std::uint8_t>(fields, "op")) {
                case kChunk:
                    add_chunk(fields, at, data_bytes);
                    break;
                case kIndex:
                    add_index(fields, file_.read(at, data_bytes));
                    break;
                case kConnection:
                    if (data_bytes > kMaxConnectionBytes) throw Error(name() + ": is damaged: a topic without end");
                    add_topic(fields, file_.read(at, data_bytes));
                    break;
                default:
                    break;  // bag header and chunk infos add nothing
            }
            at += data_bytes;
        }
    } catch (const Error& error) {
        if (chunks_.size() == 0) throw;
        add_warning(std::string(error.what()) + "; what comes before is used");
    }
    if (chunks_.size() == 0) throw Error(name() + ": the bag holds no messages");
}

void Ros1Bag::add_chunk(const Fields& fields, std::uint64_t offset, std::uint32_t bytes) {
    const auto found = fields.find("compression");
    const std::string packing = found == fields.end() ? "" : printable(found->second);
    ChunkStore::Chunk chunk{offset, bytes, field<std::uint32_t>(fields, "size"), Packing::Plain, 0};
    if (packing == "bz2")
        chunk.packing = Packing::Bz2;
    else if (packing == "lz4")
        chunk.packing = Packing::Lz4;
    else if (packing != "none")
        throw Error(name() + ": its chunks are packed in a way that is not known ('" + packing.substr(0, 16) + "')");
    else
        chunk.bytes = bytes;
    chunks_.add(chunk);
    indexed_.push_back(false);
}

/// Index of the chunk before it: for one connection, the times and places of its messages.
void Ros1Bag::add_index(const Fields& fields, const ByteBuffer& data) {
    if (chunks_.size() == 0 || field<std::uint32_t>(fields, "ver") != 1) return;
    const auto connection = field<std::uint32_t>(fields, "conn");
    const auto count = field<std::uint32_t>(fields, "count");
    ByteReader reader(data, name());
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto time = reader.take<std::uint64_t>();
        const auto offset = reader.take<std::uint32_t>();
        add_message({connection, chunks_.size() - 1, offset, nanoseconds(time)});
    }
    indexed_.back() = true;
}

void Ros1Bag::add_topic(const Fields& fields, ByteView data) {
    const auto number = field<std::uint32_t>(fields, "conn");
    const auto topic = fields.find("topic");
    const Fields description = parse_fields(data);
    const auto type = description.find("type");
    if (topic == fields.end() || type == description.end())
        throw Error(name() + ": is damaged: a connection without topic or type");
    add_connection(number, {printable(topic->second), printable(type->second), RosEncoding::Ros1});
}

/// For bags without an index: reads the records inside the chunk.
void Ros1Bag::walk_chunk(std::uint32_t number) {
    const bool messages_known = indexed_[number];
    const SharedBytes bytes = chunks_.unpacked(number);
    ByteReader reader(*bytes, name());
    while (!reader.at_end()) {
        const auto at = static_cast<std::uint32_t>(bytes->size() - reader.left());
        const auto header = reader.take_block();
        const auto data = reader.take_block();
        const Fields fields = parse_fields(header);
        const auto op = field<std::uint8_t>(fields, "op");
        if (op == kConnection) add_topic(fields, data);
        if (op != kMessage || messages_known) continue;
        add_message(
            {field<std::uint32_t>(fields, "conn"), number, at, nanoseconds(field<std::uint64_t>(fields, "time"))});
    }
}

ByteBuffer Ros1Bag::read_bytes(const Message& message, std::size_t at_most) const {
    const auto length_at = [&](std::uint64_t offset) {
        return ByteReader(chunks_.read(message.part, offset, kLengthBytes), name()).take<std::uint32_t>();
    };
    const std::uint32_t header_bytes = length_at(message.place);
    if (header_bytes > kMaxHeaderBytes) throw Error(name() + ": is damaged: a message header has no end");
    const std::uint64_t header_at = message.place + kLengthBytes;
    const Fields fields = parse_fields(chunks_.read(message.part, header_at, header_bytes));
    if (field<std::uint8_t>(fields, "op") != kMessage)
        throw Error(name() + ": is damaged: the index points at something that is no message");
    const std::uint32_t data_bytes = length_at(header_at + header_bytes);
    return chunks_.read(message.part, header_at + header_bytes + kLengthBytes,
                        std::min<std::size_t>(data_bytes, at_most));
}

}  // namespace posefusion
