#include "hosts/io/rvl.hpp"

#include <algorithm>
#include <limits>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr int kNibblesPerWord = 8, kNibbleBits = 4, kDataBits = 3;
constexpr std::uint32_t kMoreFollows = 1u << kDataBits, kData = kMoreFollows - 1;

/// Numbers of any length: nibbles of three bits, the lowest first, with a fourth that says whether more follow. Eight
/// nibbles lie in a little-endian word of 32 bits, the first one in its highest bits.
class NibbleReader {
public:
    NibbleReader(ByteView bytes, const std::string& name) : bytes_(bytes), name_(name) {}

    std::uint32_t take() {
        std::uint32_t value = 0;
        for (int shift = 0; shift < std::numeric_limits<std::uint32_t>::digits; shift += kDataBits) {
            const std::uint32_t nibble = take_nibble();
            value |= (nibble & kData) << shift;
            if ((nibble & kMoreFollows) == 0) return value;
        }
        throw Error(name_ + ": is damaged: RVL number without an end");
    }

private:
    std::uint32_t take_nibble() {
        if (left_ == 0) {
            // The last word may be cut where its remaining bytes hold nothing.
            if (bytes_.empty()) throw Error(name_ + ": is damaged: RVL depth ends early");
            word_ = 0;
            for (std::size_t i = 0; i < sizeof word_ && i < bytes_.size(); ++i)
                word_ |= static_cast<std::uint32_t>(bytes_[i]) << (8 * i);
            bytes_ = bytes_.subspan(std::min(sizeof word_, bytes_.size()));
            left_ = kNibblesPerWord;
        }
        --left_;
        return word_ >> (kNibbleBits * left_) & (kMoreFollows | kData);
    }

    ByteView bytes_;
    const std::string& name_;
    std::uint32_t word_ = 0;
    int left_ = 0;  ///< nibbles of the word
};

/// Differences of either sign as small numbers: 0, -1, 1, -2 ... become 0, 1, 2, 3 ...
std::int64_t from_zigzag(std::uint32_t value) {
    return static_cast<std::int64_t>(value >> 1) ^ -static_cast<std::int64_t>(value & 1);
}

}  // namespace

RawDepth decode_rvl(ByteView bytes, ImageSize size, const std::string& name) {
    RawDepth depth(size.width, size.height);
    NibbleReader numbers(bytes, name);
    std::int64_t value = 0;
    for (std::size_t at = 0; at < depth.size();) {
        const std::size_t zeros = numbers.take();
        if (zeros > depth.size() - at) throw Error(name + ": is damaged: RVL depth has more pixels than the image");
        at += zeros;  // a new image is all zeros
        const std::size_t measurements = numbers.take();
        if (measurements > depth.size() - at)
            throw Error(name + ": is damaged: RVL depth has more pixels than the image");
        for (const std::size_t end = at + measurements; at < end; ++at) {
            value += from_zigzag(numbers.take());
            if (value < 0 || value > std::numeric_limits<std::uint16_t>::max())
                throw Error(name + ": is damaged: RVL depth holds a value that is no depth");
            depth[at] = static_cast<std::uint16_t>(value);
        }
    }
    return depth;
}

}  // namespace posefusion
