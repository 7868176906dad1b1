#pragma once
#include <cstdint>
#include <utility>

#include "hosts/io/image_file.hpp"

/// Writes RVL, see hosts/io/rvl.hpp.
namespace posefusion::test {

class NibbleWriter {
public:
    void put(std::uint32_t value) {
        do {
            std::uint32_t nibble = value & 7;
            value >>= 3;
            if (value != 0) nibble |= 8;
            word_ = word_ << 4 | nibble;
            if (++used_ == 8) flush();
        } while (value != 0);
    }
    ByteBuffer take() {
        if (used_ > 0) {
            word_ <<= 4 * (8 - used_);
            flush();
        }
        return std::move(bytes_);
    }

private:
    void flush() {
        for (std::size_t i = 0; i < sizeof word_; ++i) bytes_.push_back(static_cast<std::uint8_t>(word_ >> (8 * i)));
        word_ = 0;
        used_ = 0;
    }
    ByteBuffer bytes_;
    std::uint32_t word_ = 0;
    int used_ = 0;
};

inline std::uint32_t to_zigzag(std::int32_t value) {
    return static_cast<std::uint32_t>(value) << 1 ^ static_cast<std::uint32_t>(value >> 31);
}

inline ByteBuffer encode_rvl(const RawDepth& depth) {
    NibbleWriter numbers;
    std::int32_t previous = 0;
    for (std::size_t at = 0; at < depth.size();) {
        std::size_t zeros = at;
        while (zeros < depth.size() && depth[zeros] == 0) ++zeros;
        numbers.put(static_cast<std::uint32_t>(zeros - at));
        at = zeros;
        std::size_t end = at;
        while (end < depth.size() && depth[end] != 0) ++end;
        numbers.put(static_cast<std::uint32_t>(end - at));
        for (; at < end; ++at) {
            numbers.put(to_zigzag(depth[at] - previous));
            previous = depth[at];
        }
    }
    return numbers.take();
}

}  // namespace posefusion::test
