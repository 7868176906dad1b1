#include <cmath>

#include "hosts/io/sources/oni_source.hpp"
#include "tests/hosts/io/sources/frames.hpp"

namespace posefusion::test {
namespace {

template <class Number>
std::string number(Number value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
}
std::string block(const std::string& text) { return number(static_cast<std::uint32_t>(text.size())) + text; }

/// Writes .oni files record by record.
struct OniWriter {
    std::string content = "NI10" + std::string(20, '\0');

    void record(std::uint32_t type, std::uint32_t node, const std::string& fields, const std::string& payload = {}) {
        content += number(std::uint32_t{0x0052494E}) + number(type) + number(node) +
                   number(static_cast<std::uint32_t>(28 + fields.size())) +
                   number(static_cast<std::uint32_t>(payload.size())) + number(std::uint64_t{0}) + fields + payload;
    }
    void node(std::uint32_t node, std::uint32_t type, const std::string& codec, int width = kWidth,
              int height = kHeight, bool view = true) {
        record(13, node, block(std::string("Node\0", 5)) + number(type) + codec + std::string(28, '\0'));
        record(6, node,
               block(std::string("xnMapOutputMode\0", 16)) + block(number(width) + number(height) + number(30)));
        record(3, node,
               block(std::string("oniPixelFormat\0", 15)) + block(number(std::uint64_t{type == 2 ? 100U : 200U})));
        if (view) record(6, node, block(std::string("xnFOV\0", 6)) + block(number(1.0) + number(0.8)));
    }
    void image(std::uint32_t node, std::uint64_t microseconds, const std::string& data) {
        record(10, node, number(microseconds) + number(std::uint32_t{1}), data);
    }
    std::string finish() {
        record(11, 0, "");
        return content;
    }
};

template <class Pixels>
std::string bytes_of(const Pixels& image) {
    return {reinterpret_cast<const char*>(image.data()), image.size() * sizeof(*image.data())};
}

OniWriter good(int frames = 2) {
    OniWriter oni;
    oni.node(1, 2, "NONE");
    oni.node(2, 3, "NONE");
    for (int i = 0; i < frames; ++i) {
        oni.image(1, 1000 + 33333 * static_cast<std::uint64_t>(i), bytes_of(make_frame(i).depth));
        oni.image(2, 33333 * static_cast<std::uint64_t>(i), bytes_of(make_frame(i).color));
    }
    return oni;
}

class Oni : public testing::Test {
protected:
    std::string fault(const std::string& content) const { return open_fault(folder.write("a.oni", content)); }
    TempFolder folder;
};

/// FNV-1a.
std::uint64_t hash_of(const std::string& bytes) {
    std::uint64_t hash = 1469598103934665603ULL;  // any start will do, it only has to be the same
    for (const char c : bytes) hash = (hash ^ static_cast<std::uint8_t>(c)) * 1099511628211ULL;
    return hash;
}

/// Recorded by OpenNI2 2.2 itself, from the camera "Dummy" that it brings along; the numbers are those of the images as
/// it showed them while it recorded.
TEST_F(Oni, RecordedByOpenNiIsReadBitForBit) {
    SourceOptions options;
    options.camera_file = folder.write("c.yaml", "fx: 300\nfy: 300\ncx: 160\ncy: 120\nwidth: 320\nheight: 240\n");
    const auto source = open_source(std::filesystem::path(POSEFUSION_TEST_DATA) / "dummy.oni", options);
    ASSERT_EQ(source->size(), 3u);
    EXPECT_EQ(source->camera().depth_scale, 1000);
    const std::uint64_t depth[] = {0x43cf1a573cc46c2, 0x5d4f55013e1c616e, 0x31c3999bc0cbe8c2};
    for (const std::size_t i : {2, 0, 1}) {
        const RawFrame frame = source->read(i);
        EXPECT_EQ(hash_of(bytes_of(frame.depth)), depth[i]) << i;
        EXPECT_EQ(frame.stamp, std::chrono::milliseconds(33 * i));
        EXPECT_NEAR(frame.color(160, 120).g, 127, 4) << "JPEG";
    }
    EXPECT_TRUE(
        has(open_fault(std::filesystem::path(POSEFUSION_TEST_DATA) / "dummy.oni"), "does not say what its camera is"));
}

TEST_F(Oni, GivesWhatWentIn) {
    const auto source = open_source(folder.write("a.oni", good().finish()));
    ASSERT_EQ(source->size(), 2u);
    EXPECT_NEAR(source->camera().intrinsics.fx, kWidth / 2.0 / std::tan(0.5), 1e-4);
    ASSERT_EQ(source->facts().warnings.size(), 1u) << "a nominal camera";
    const RawFrame frame = source->read(1), expected = make_frame(1);
    EXPECT_EQ(frame.stamp_text, "0.033333");
    EXPECT_TRUE(std::equal(frame.depth.begin(), frame.depth.end(), expected.depth.begin()));
    EXPECT_TRUE(std::equal(frame.color.begin(), frame.color.end(), expected.color.begin()));
}

TEST_F(Oni, DepthCodesAreUnderstood) {
    const auto decode = [](const std::string& packed, bool table, std::size_t pixels) {
        std::vector<std::uint16_t> image(pixels);
        decode_oni_depth({reinterpret_cast<const std::uint8_t*>(packed.data()), packed.size()}, table, image, "x");
        return image;
    };
    using Values = std::vector<std::uint16_t>;
    const std::string thousand("\xE8\x03", 2);
    EXPECT_EQ(decode(thousand + "\x57", false, 3), (Values{1000, 1001, 1000})) << "differences";
    EXPECT_EQ(decode(thousand + "\xE2", false, 5), (Values{1000, 1000, 1000, 1000, 1000})) << "repetition";
    EXPECT_EQ(decode(thousand + "\xFF\x07\xD0", false, 2), (Values{1000, 2000})) << "in full";
    EXPECT_EQ(decode(thousand + "\xFF\xCA", false, 2), (Values{1000, 990})) << "a larger difference";
    EXPECT_EQ(decode(thousand + "\x6F\x07\xD0", false, 3), (Values{1000, 1000, 2000})) << "half a byte, then in full";
    EXPECT_EQ(decode(thousand + "\x5D", false, 2), (Values{1000, 1001})) << "one value in a byte";
    EXPECT_EQ(decode(thousand + "\x5D\xE1", false, 4), (Values{1000, 1001, 1001, 1001}));
    EXPECT_EQ(decode(std::string("\2\0\x64\0\xC8\0", 6) + std::string("\0\0", 2) + "\x56", true, 3),
              (Values{100, 200, 200}));
    for (const std::string& bad :
         {std::string(), std::string("\xE8"), thousand, thousand + "\xF3", thousand + "\xFF", thousand + "\xFF\x07",
          thousand + "\x66\x66", thousand + "\xDD\x66", thousand + "\x6E"})
        EXPECT_TRUE(has(message_of<Error>([&] { (void)decode(bad, false, 3); }), "is damaged")) << bad.size();
    EXPECT_THROW((void)decode(std::string("\2\0\x64\0\xC8\0\5\0\xE1", 9), true, 3), Error) << "beyond the table";
    EXPECT_THROW((void)decode("\xFF\xFF", true, 3), Error) << "a table without end";
}

TEST_F(Oni, BadFilesAreNamed) {
    EXPECT_TRUE(has(fault(""), "too short"));
    EXPECT_TRUE(has(fault(std::string(100, 'x')), "is no .oni file"));
    EXPECT_TRUE(has(fault("NI10" + std::string(20, '\0')), "ends early"));
    EXPECT_TRUE(has(fault("NI10" + std::string(20, '\0') + std::string(28, '\xFF')), "is damaged"));
    EXPECT_TRUE(has(fault(OniWriter().finish()), "holds no colour images"));
    OniWriter codec;
    codec.node(1, 2, "ABCD");
    codec.node(2, 3, "NONE");
    codec.image(1, 0, "x");
    codec.image(2, 0, "x");
    EXPECT_TRUE(has(fault(codec.finish()), "of a kind that cannot be read"));
    OniWriter size;
    size.node(1, 2, "NONE", 1 << 30, 1 << 30);
    size.node(2, 3, "NONE", 1 << 30, 1 << 30);
    size.image(1, 0, "x");
    size.image(2, 0, "x");
    EXPECT_TRUE(has(fault(size.finish()), "impossible"));
    OniWriter apart = good(0);
    apart.image(1, 0, "x");
    apart.image(2, 50000, "x");
    EXPECT_TRUE(has(fault(apart.finish()), "within 20 ms"));
    OniWriter empty = good(0);
    empty.image(1, 0, "x");
    empty.image(2, 0, "x");
    const auto file = folder.write("a.oni", empty.finish());
    EXPECT_TRUE(has(message_of<Error>([&] { (void)open_source(file)->read(0); }), "not as much data as pixels"));
}

TEST_F(Oni, ATruncatedFileIsUsedAsFarAsItGoes) {
    const std::string content = good(3).finish();
    const auto source = open_source(folder.write("a.oni", content.substr(0, content.size() - 100)));
    EXPECT_EQ(source->size(), 2u);
    EXPECT_TRUE(has(source->facts().warnings[0], "what comes before is used"));
}

TEST_F(Oni, NoDamageDoesHarm) { expect_no_harm_in_damage(folder.write("a.oni", good(1).finish()), 29); }

}  // namespace
}  // namespace posefusion::test
