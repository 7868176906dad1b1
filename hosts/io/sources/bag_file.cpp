#include "hosts/io/sources/bag_file.hpp"

#include <bzlib.h>
#include <lz4frame.h>

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
/// Largest chunk, unpacked. rosbag's own are 768 KiB, or one message if that is larger.
constexpr std::uint32_t kMaxChunkBytes = 1U << 28;
constexpr std::size_t kMaxConnections = 1U << 16;
/// Four hours at 1 kHz.
constexpr std::size_t kMaxMessages = std::size_t{1} << 24;
/// A chunk that claims to grow by more when it is unpacked is a trap. lz4 cannot do more; bz2 only with nothing but
/// zeros.
constexpr std::uint64_t kMaxLz4Growth = 256, kMaxBz2Growth = 32768;
constexpr std::size_t kChunksKept = 3;
constexpr std::uint64_t kNanoseconds = 1'000'000'000;
constexpr std::size_t kLengthBytes = sizeof(std::uint32_t);

enum Op : std::uint8_t { kMessage = 2, kBagHeader = 3, kIndex = 4, kChunk = 5, kChunkInfo = 6, kConnection = 7 };

std::uint64_t nanoseconds(std::uint64_t time) { return (time & 0xFFFFFFFF) * kNanoseconds + (time >> 32); }

/// @return bytes written; SIZE_MAX if the data is damaged
std::size_t unpack_lz4(const ByteBuffer& packed, ByteBuffer& to) {
    LZ4F_dctx* context = nullptr;
    if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)) != 0U) return SIZE_MAX;
    const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> owner(context,
                                                                                     &LZ4F_freeDecompressionContext);
    std::size_t written = 0, taken = 0;
    while (taken < packed.size()) {
        std::size_t room = to.size() - written, rest = packed.size() - taken;
        const std::size_t hint =
            LZ4F_decompress(context, to.data() + written, &room, packed.data() + taken, &rest, nullptr);
        if (LZ4F_isError(hint) != 0U || (room == 0 && rest == 0)) return SIZE_MAX;
        written += room;
        taken += rest;
        if (hint == 0) break;
    }
    return written;
}

std::size_t unpack_bz2(ByteBuffer& packed, ByteBuffer& to) {
    auto written = static_cast<unsigned int>(to.size());
    const int result =
        BZ2_bzBuffToBuffDecompress(reinterpret_cast<char*>(to.data()), &written, reinterpret_cast<char*>(packed.data()),
                                   static_cast<unsigned int>(packed.size()), 0, 0);
    return result == BZ_OK ? written : SIZE_MAX;
}

}  // namespace

BagFile::BagFile(const std::filesystem::path& file) : file_(file) {
    if (file_.size() < kMagic.size()) throw Error(name() + ": is not a ROS bag");
    const ByteBuffer head = file_.read(0, kMagic.size());
    const std::string start(head.begin(), head.end());
    if (start != kMagic)
        throw Error(name() + (start.starts_with("#ROSBAG V")
                                  ? ": is a bag of another version than 2.0; convert it with "
                                    "`rosbag fix`"
                                  : ": is not a ROS bag"));
    walk_file();
    const bool topics_known = !connections_.empty();
    std::size_t bad_chunks = 0;
    std::string first_fault;
    for (std::uint32_t i = 0; i < chunks_.size(); ++i) {
        if (topics_known && chunks_[i].indexed) continue;
        try {
            walk_chunk(i);
        } catch (const Error& error) {
            if (bad_chunks++ == 0) first_fault = error.what();
        }
    }
    if (connections_.empty() && bad_chunks > 0) throw Error(first_fault);
    if (bad_chunks > 0)
        warnings_.push_back(first_fault + " (" + std::to_string(bad_chunks) + " of " + std::to_string(chunks_.size()) +
                            " chunks are damaged)");
    if (messages_.empty()) throw Error(name() + ": the bag holds no messages");
    std::stable_sort(messages_.begin(), messages_.end(),
                     [](const Message& a, const Message& b) { return a.recorded < b.recorded; });
}

BagFile::Fields BagFile::parse_fields(ByteView header) const {
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
Number BagFile::field(const Fields& fields, const char* key) const {
    const auto found = fields.find(key);
    if (found == fields.end() || found->second.size() != sizeof(Number))
        throw Error(name() + ": is damaged: a record lacks '" + key + "'");
    return ByteReader(found->second, name()).take<Number>();
}

/// Visits all records of the file without unpacking chunks.
void BagFile::walk_file() {
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
                    add_connection(fields, file_.read(at, data_bytes));
                    break;
                default:
                    break;  // bag header and chunk infos add nothing
            }
            at += data_bytes;
        }
    } catch (const Error& error) {
        if (chunks_.empty()) throw;
        warnings_.push_back(std::string(error.what()) + "; what comes before is used");
    }
    if (chunks_.empty()) throw Error(name() + ": the bag holds no messages");
}

void BagFile::add_chunk(const Fields& fields, std::uint64_t offset, std::uint32_t bytes) {
    const auto found = fields.find("compression");
    const std::string packing = found == fields.end() ? "" : printable(found->second);
    Chunk chunk;
    chunk.offset = offset;
    chunk.packed_bytes = bytes;
    chunk.bytes = field<std::uint32_t>(fields, "size");
    if (packing == "bz2")
        chunk.packing = Packing::Bz2;
    else if (packing == "lz4")
        chunk.packing = Packing::Lz4;
    else if (packing != "none")
        throw Error(name() + ": its chunks are packed in a way that is not known ('" + packing.substr(0, 16) + "')");
    if (chunk.packing == Packing::Plain) chunk.bytes = std::min(chunk.bytes, bytes);
    if (chunk.bytes > kMaxChunkBytes || bytes > kMaxChunkBytes)
        throw Error(name() + ": a chunk has more than " + std::to_string(kMaxChunkBytes >> 20) + " MiB");
    const std::uint64_t growth = chunk.packing == Packing::Bz2 ? kMaxBz2Growth : kMaxLz4Growth;
    if (chunk.bytes > growth * bytes) throw Error(name() + ": is damaged: a packed chunk claims to be enormous");
    chunks_.push_back(chunk);
}

/// Index of the chunk before it: for one connection, the times and places of its messages.
void BagFile::add_index(const Fields& fields, const ByteBuffer& data) {
    if (chunks_.empty() || field<std::uint32_t>(fields, "ver") != 1) return;
    const auto connection = field<std::uint32_t>(fields, "conn");
    const auto count = field<std::uint32_t>(fields, "count");
    ByteReader reader(data, name());
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto time = reader.take<std::uint64_t>();
        const auto offset = reader.take<std::uint32_t>();
        if (messages_.size() == kMaxMessages) throw Error(name() + ": holds too many messages");
        messages_.push_back({connection, static_cast<std::uint32_t>(chunks_.size() - 1), offset, nanoseconds(time)});
    }
    chunks_.back().indexed = true;
}

void BagFile::add_connection(const Fields& fields, ByteView data) {
    const auto number = field<std::uint32_t>(fields, "conn");
    const auto topic = fields.find("topic");
    const Fields description = parse_fields(data);
    const auto type = description.find("type");
    if (topic == fields.end() || type == description.end())
        throw Error(name() + ": is damaged: a connection without topic or type");
    if (connections_.size() == kMaxConnections) throw Error(name() + ": holds too many topics");
    connections_[number] = {printable(topic->second), printable(type->second)};
}

/// For bags without an index: reads the records inside the chunk.
void BagFile::walk_chunk(std::uint32_t number) {
    const bool messages_known = chunks_[number].indexed;
    const SharedBytes bytes = unpacked(number);
    ByteReader reader(*bytes, name());
    while (!reader.at_end()) {
        const auto at = static_cast<std::uint32_t>(bytes->size() - reader.left());
        const auto header = reader.take_block();
        const auto data = reader.take_block();
        const Fields fields = parse_fields(header);
        const auto op = field<std::uint8_t>(fields, "op");
        if (op == kConnection) add_connection(fields, data);
        if (op != kMessage || messages_known) continue;
        if (messages_.size() == kMaxMessages) throw Error(name() + ": holds too many messages");
        messages_.push_back(
            {field<std::uint32_t>(fields, "conn"), number, at, nanoseconds(field<std::uint64_t>(fields, "time"))});
    }
}

std::vector<BagFile::Message> BagFile::messages(const std::vector<std::string>& topics) const {
    std::vector<Message> wanted;
    for (const Message& message : messages_) {
        const auto connection = connections_.find(message.connection);
        if (connection == connections_.end()) continue;
        if (std::find(topics.begin(), topics.end(), connection->second.topic) != topics.end())
            wanted.push_back(message);
    }
    return wanted;
}

ByteBuffer BagFile::unpack(const Chunk& chunk) const {
    ByteBuffer packed = file_.read(chunk.offset, chunk.packed_bytes);
    if (chunk.packing == Packing::Plain) return packed;
    ByteBuffer bytes(chunk.bytes);
    const std::size_t written = chunk.packing == Packing::Bz2 ? unpack_bz2(packed, bytes) : unpack_lz4(packed, bytes);
    if (written != bytes.size()) throw Error(name() + ": is damaged: a packed chunk cannot be unpacked");
    return bytes;
}

BagFile::SharedBytes BagFile::unpacked(std::uint32_t number) const {
    const std::lock_guard lock(mutex_);
    const auto found =
        std::find_if(unpacked_.begin(), unpacked_.end(), [&](const auto& kept) { return kept.first == number; });
    if (found != unpacked_.end()) return found->second;
    auto bytes = std::make_shared<const ByteBuffer>(unpack(chunks_.at(number)));
    if (unpacked_.size() == kChunksKept) unpacked_.pop_front();
    unpacked_.emplace_back(number, bytes);
    return bytes;
}

ByteBuffer BagFile::read_at(const Chunk& chunk, std::uint32_t offset, std::size_t count) const {
    if (offset > chunk.bytes || count > chunk.bytes - offset)
        throw Error(name() + ": is damaged: a message lies outside its chunk");
    if (chunk.packing == Packing::Plain) return file_.read(chunk.offset + offset, count);
    const SharedBytes bytes = unpacked(static_cast<std::uint32_t>(&chunk - chunks_.data()));
    const auto begin = bytes->begin() + static_cast<std::ptrdiff_t>(offset);
    return {begin, begin + static_cast<std::ptrdiff_t>(count)};
}

ByteBuffer BagFile::read(const Message& message, std::size_t at_most) const {
    const Chunk& chunk = chunks_.at(message.chunk);
    const auto length_at = [&](std::uint32_t offset) {
        return ByteReader(read_at(chunk, offset, kLengthBytes), name()).take<std::uint32_t>();
    };
    const std::uint32_t header_bytes = length_at(message.offset);
    if (header_bytes > kMaxHeaderBytes) throw Error(name() + ": is damaged: a message header has no end");
    const auto header_at = static_cast<std::uint32_t>(message.offset + kLengthBytes);
    const Fields fields = parse_fields(read_at(chunk, header_at, header_bytes));
    if (field<std::uint8_t>(fields, "op") != kMessage)
        throw Error(name() + ": is damaged: the index points at something that is no message");
    const std::uint32_t data_bytes = length_at(header_at + header_bytes);
    return read_at(chunk, static_cast<std::uint32_t>(header_at + header_bytes + kLengthBytes),
                   std::min<std::size_t>(data_bytes, at_most));
}

}  // namespace posefusion
