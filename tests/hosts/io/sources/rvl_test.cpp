#include "hosts/io/rvl.hpp"

#include <gtest/gtest.h>

#include <random>

#include "engine/core/error.hpp"
#include "tests/hosts/io/sources/frames.hpp"
#include "tests/hosts/io/sources/rvl_writer.hpp"

namespace posefusion::test {
namespace {

std::string fault(const ByteBuffer& bytes, ImageSize size) {
    return message_of<Error>([&] { (void)decode_rvl(bytes, size, "d"); });
}

/// By hand from the paper: 0 5 4 is one zero (1), two measurements (2), +5 as zigzag 10 = 001 010 (A 1), -1 as zigzag 1
/// (1): the nibbles 1 2 A 1 1, from the highest of a little-endian word downwards.
TEST(Rvl, IsThatOfThePaper) {
    const RawDepth depth = decode_rvl(ByteBuffer{0x00, 0x10, 0xA1, 0x12}, {3, 1}, "d");
    EXPECT_EQ(depth[0], 0);
    EXPECT_EQ(depth[1], 5);
    EXPECT_EQ(depth[2], 4);
}

TEST(Rvl, EveryImageComesBack) {
    std::mt19937 random(7);
    for (int i = 0; i < 200; ++i) {
        RawDepth depth(1 + static_cast<int>(random() % 40), 1 + static_cast<int>(random() % 30));
        const auto holes = random() % 11, range = 1 + (1ul << (random() % 17)) % 65536;
        for (std::uint16_t& d : depth)
            d = random() % 10 < holes ? std::uint16_t{0} : static_cast<std::uint16_t>(random() % range);
        const RawDepth read = decode_rvl(encode_rvl(depth), {depth.width(), depth.height()}, "d");
        ASSERT_TRUE(std::equal(read.begin(), read.end(), depth.begin())) << i;
    }
}

TEST(Rvl, DamageIsNamed) {
    const RawDepth depth = make_frame(0).depth;
    const ImageSize size{depth.width(), depth.height()};
    const ByteBuffer good = encode_rvl(depth);
    EXPECT_EQ(fault(good, size), "");
    for (std::size_t length = 0; length + 8 < good.size(); ++length)
        // a number that is cut off may also claim too many pixels
        ASSERT_TRUE(fault(ByteBuffer(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(length)), size)
                        .starts_with("d: is damaged: RVL"))
            << length;
    EXPECT_EQ(fault(good, {size.width, size.height / 2}), "d: is damaged: RVL depth has more pixels than the image");
    EXPECT_EQ(fault(ByteBuffer(64, 0xFF), size), "d: is damaged: RVL number without an end");
    // 0 zeros, 1 measurement, zigzag 1 = -1
    EXPECT_EQ(fault({0, 0, 0x10, 0x01}, {1, 1}), "d: is damaged: RVL depth holds a value that is no depth");
}

TEST(Rvl, SpoiltBytesAreAnErrorOrAnImage) {
    const RawDepth depth = make_frame(0).depth;
    const ByteBuffer good = encode_rvl(depth);
    for (std::size_t at = 0; at < good.size(); ++at) {
        for (const unsigned char spoilt : {'\xFF', '\x7F', '\0', 'Z'}) {
            ByteBuffer bad = good;
            bad[at] = spoilt;
            EXPECT_EQ(fault(bad, {depth.width(), depth.height()}).find('\n'), std::string::npos);
        }
    }
}

}  // namespace
}  // namespace posefusion::test
