#include "hosts/io/sources/bags/message_bag.hpp"

#include <algorithm>

#include "engine/core/error.hpp"
#include "hosts/io/sources/bags/packing.hpp"

namespace posefusion {
namespace {

constexpr std::size_t kMaxConnections = 1U << 16;
/// Four hours at 1 kHz.
constexpr std::size_t kMaxMessages = std::size_t{1} << 24;
/// The year 2116, and the time of damaged messages that claim a later one: differences of times do not overflow.
constexpr std::uint64_t kLatest = std::uint64_t{1} << 62;

}  // namespace

void MessageBag::add_connection(std::uint32_t number, Connection connection) {
    if (connections_.size() == kMaxConnections && !connections_.contains(number))
        throw Error(name() + ": holds too many topics");
    connections_.insert_or_assign(number, std::move(connection));
}

void MessageBag::add_message(const Message& message) {
    if (messages_.size() == kMaxMessages) throw Error(name() + ": holds too many messages");
    messages_.push_back(message);
    messages_.back().recorded = std::min(message.recorded, kLatest);
}

void MessageBag::drop_messages(std::uint32_t part) {
    std::erase_if(messages_, [&](const Message& message) { return message.part == part; });
}

void MessageBag::finish() {
    if (messages_.empty()) throw Error(name() + ": the bag holds no messages");
    std::stable_sort(messages_.begin(), messages_.end(),
                     [](const Message& a, const Message& b) { return a.recorded < b.recorded; });
}

std::vector<MessageBag::Message> MessageBag::messages(const std::vector<std::string>& topics) const {
    std::vector<Message> wanted;
    for (const Message& message : messages_) {
        const auto connection = connections_.find(message.connection);
        if (connection == connections_.end()) continue;
        if (std::find(topics.begin(), topics.end(), connection->second.topic) != topics.end())
            wanted.push_back(message);
    }
    return wanted;
}

RosMessage MessageBag::read(const Message& message, std::size_t at_most) const {
    const RosEncoding encoding = connections_.at(message.connection).encoding;
    ByteBuffer bytes = read_bytes(message, at_most);
    if (encoding != RosEncoding::Cdr || !is_zstd(bytes)) return {encoding, std::move(bytes)};
    if (at_most != SIZE_MAX) bytes = read_bytes(message, std::max(at_most, kZstdPrefixBytes));
    return {encoding, unpack_zstd(bytes, std::min<std::size_t>(at_most, kMaxChunkBytes), name())};
}

}  // namespace posefusion
