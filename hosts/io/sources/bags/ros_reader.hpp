#pragma once
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <type_traits>

#include "hosts/io/input_file.hpp"
#include "hosts/io/stamp.hpp"

/// The fields of serialised ROS messages, whichever of the two ways they are written.
namespace posefusion {

/// How a message was serialised.
enum class RosEncoding {
    Ros1,  ///< http://wiki.ros.org/roscpp/Overview/MessagesSerializationAndAdaptingTypes
    Cdr,   ///< ROS 2: plain CDR of either byte order (OMG DDS-RTPS 2.2, section 10)
};

/// A message as it is stored.
struct RosMessage {
    RosEncoding encoding = RosEncoding::Ros1;
    ByteBuffer bytes;
};

/// Takes the fields of a message one after the other; beyond the end it throws Error.
///
/// The two serialisations write the same fields in the same order. CDR aligns each number to its own size, counted from
/// the end of its four bytes of encapsulation, and ends a text with a zero.
class RosReader {
public:
    /// @param name  what is read, for the message of an Error
    /// Throws Error for an encapsulation that is not plain CDR. The message must outlive the reader.
    RosReader(const RosMessage& message, const std::string& name);

    template <class Number>
    [[nodiscard]] Number take() {
        static_assert(std::is_arithmetic_v<Number>);
        align(sizeof(Number));
        std::array<std::uint8_t, sizeof(Number)> bytes;
        const ByteView view = reader_.take(sizeof(Number));
        std::copy(view.begin(), view.end(), bytes.begin());
        if (big_endian_) std::reverse(bytes.begin(), bytes.end());
        Number value;
        std::memcpy(&value, bytes.data(), sizeof value);
        return value;
    }
    [[nodiscard]] ByteView take_block();    ///< a sequence of bytes with its length before it
    [[nodiscard]] std::string take_text();  ///< printable, no longer than names of frames and encodings are
    [[nodiscard]] Stamp take_stamp();       ///< of a std_msgs/Header, with what comes before it
    [[nodiscard]] std::string
    take_header();  ///< all of it; its frame, without the slash that tf wrote and tf2 does not
    [[nodiscard]] std::size_t left() const { return reader_.left(); }

private:
    void align(std::size_t size);

    ByteReader reader_;
    bool aligned_ = false, big_endian_ = false;
    std::size_t begin_ = 0;  ///< left() at the place that alignment counts from
};

}  // namespace posefusion
