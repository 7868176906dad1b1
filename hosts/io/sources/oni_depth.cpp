#include "engine/core/error.hpp"
#include "hosts/io/sources/oni_source.hpp"

namespace posefusion {
namespace {

constexpr int kZero = 6;                                   ///< a nibble of this value is no difference
constexpr int kNothing = 0xD, kRepeat = 0xE, kFull = 0xF;  ///< nibbles with another meaning
constexpr int kWholeByteFull = 0xFF;
constexpr int kSmall = 0x80;     ///< a full value with this bit is a difference ...
constexpr int kSmallZero = 192;  ///< ... from here

class Decoder {
public:
    Decoder(ByteView packed, std::span<std::uint16_t> pixels, const std::string& name)
        : in_(packed, name), pixels_(pixels), name_(name) {}

    void decode() {
        if (pixels_.empty()) return;
        last_ = in_.take<std::uint16_t>();
        put();
        while (!in_.at_end()) step();
        if (done_ < pixels_.size()) fail();
    }

private:
    [[noreturn]] void fail() const { throw Error(name_ + ": is damaged: it is not coded as OpenNI does it"); }

    void put() {
        if (done_ == pixels_.size()) fail();
        pixels_[done_++] = static_cast<std::uint16_t>(last_);
    }
    void change(int difference) {
        last_ -= difference;
        put();
    }
    void take_full() {
        const int first = in_.take<std::uint8_t>();
        if ((first & kSmall) != 0)
            last_ -= first - kSmallZero;
        else
            last_ = first << 8 | in_.take<std::uint8_t>();
        put();
    }

    void step() {
        const int code = in_.take<std::uint8_t>();
        const int high = code >> 4, low = code & 0xF;
        if (high < kNothing) {
            change(high - kZero);
            if (low == kFull)
                take_full();
            else if (low < kNothing)
                change(low - kZero);
            else if (low != kNothing)
                fail();
        } else if (code == kWholeByteFull) {
            take_full();
        } else if (high == kRepeat) {
            for (int i = 0; i < 2 * low; ++i) put();
        } else {
            fail();
        }
    }

    ByteReader in_;
    std::span<std::uint16_t> pixels_;
    const std::string& name_;
    std::size_t done_ = 0;
    int last_ = 0;
};

}  // namespace

void decode_oni_depth(ByteView packed, bool with_table, std::span<std::uint16_t> pixels, const std::string& name) {
    if (!with_table) {
        Decoder(packed, pixels, name).decode();
        return;
    }
    ByteReader reader(packed, name);
    std::vector<std::uint16_t> table(reader.take<std::uint16_t>());
    for (std::uint16_t& value : table) value = reader.take<std::uint16_t>();
    Decoder(reader.take(reader.left()), pixels, name).decode();
    for (std::uint16_t& pixel : pixels) {
        if (pixel >= table.size()) throw Error(name + ": is damaged: it is not coded as OpenNI does it");
        pixel = table[pixel];
    }
}

}  // namespace posefusion
