#include "hosts/io/sources/bags/ros_reader.hpp"

#include <utility>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr std::size_t kMostText = 64;  ///< letters of an encoding or a frame that are kept

enum Encapsulation : std::uint8_t { kCdrBigEndian = 0, kCdrLittleEndian = 1 };

}  // namespace

RosReader::RosReader(const RosMessage& message, const std::string& name)
    : reader_(message.bytes, name), aligned_(message.encoding == RosEncoding::Cdr) {
    if (!aligned_) return;
    const ByteView encapsulation = reader_.take(4);  // two bytes of kind, two of options
    const std::uint8_t kind = encapsulation[1];
    if (encapsulation[0] != 0 || kind > kCdrLittleEndian)
        throw Error(name + ": is not serialised as ROS 2 does it (plain CDR)");
    big_endian_ = kind == kCdrBigEndian;
    begin_ = reader_.left();
}

void RosReader::align(std::size_t size) {
    if (!aligned_) return;
    const std::size_t at = begin_ - reader_.left();
    (void)reader_.take((size - at % size) % size);
}

ByteView RosReader::take_block() {
    const auto length = take<std::uint32_t>();
    return reader_.take(length);
}

std::string RosReader::take_text() {
    ByteView bytes = take_block();
    if (aligned_ && !bytes.empty() && bytes.back() == 0) bytes = bytes.first(bytes.size() - 1);
    return printable(bytes.first(std::min(bytes.size(), kMostText)));
}

Stamp RosReader::take_stamp() {
    if (!aligned_) (void)take<std::uint32_t>();  // sequence number
    const std::chrono::seconds seconds(take<std::uint32_t>());
    return seconds + std::chrono::nanoseconds(take<std::uint32_t>());
}

std::string RosReader::take_header() {
    (void)take_stamp();
    std::string frame = take_text();
    return frame.starts_with('/') ? frame.substr(1) : frame;
}

}  // namespace posefusion
