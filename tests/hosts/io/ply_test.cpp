#include "hosts/io/ply.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "engine/core/error.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

using test::message_of;
using test::read_all;
using test::TempFolder;

std::vector<Surfel> some_surfels(std::size_t count) {
    std::vector<Surfel> surfels(count);
    for (std::size_t i = 0; i < count; ++i) {
        const auto x = static_cast<float>(i);
        surfels[i] = {{x, -x / 3, 0.5f},
                      {0, 0.6f, -0.8f},
                      {static_cast<std::uint8_t>(i), 2, 3},
                      0.01f * x,
                      10.5f,
                      static_cast<std::uint32_t>(i),
                      4000000000u};
    }
    return surfels;
}

template <class T>
void append(std::string& to, T value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    to.append(bytes, sizeof value);
}

TEST(Ply, HeaderAndBytesAreExactlyThese) {
    const TempFolder folder;
    const Surfel s{{1, 2, 3}, {0, 0, -1}, {10, 20, 30}, 0.25f, 12, 7, 9};
    write_ply(folder / "m.ply", {s}, {"a map", "of two\nlines"});
    std::string expected =
        "ply\nformat binary_little_endian 1.0\ncomment a map\ncomment of two lines\nelement vertex 1\n"
        "property float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float "
        "nz\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float radius\nproperty float "
        "confidence\n"
        "property uint created\nproperty uint last_seen\nend_header\n";
    for (const float f : {1.0f, 2.0f, 3.0f, 0.0f, 0.0f, -1.0f}) append(expected, f);
    expected += "\x0a\x14\x1e";
    append(expected, 0.25f), append(expected, 12.0f);
    append(expected, std::uint32_t{7}), append(expected, std::uint32_t{9});
    EXPECT_EQ(read_all(folder / "m.ply"), expected);
}

TEST(Ply, RoundTripKeepsEverything) {
    const TempFolder folder;
    for (const std::size_t count : {0u, 1u, 4096u, 10000u}) {
        const auto written = some_surfels(count);
        write_ply(folder / "m.ply", written);
        const auto read = read_ply(folder / "m.ply");
        ASSERT_EQ(read.size(), written.size());
        for (std::size_t i = 0; i < count; ++i) {
            ASSERT_EQ(read[i].position, written[i].position);
            ASSERT_EQ(read[i].normal, written[i].normal);
            ASSERT_EQ(read[i].color, written[i].color);
            ASSERT_EQ(read[i].radius, written[i].radius);
            ASSERT_EQ(read[i].confidence, written[i].confidence);
            ASSERT_EQ(read[i].created, written[i].created);
            ASSERT_EQ(read[i].last_seen, written[i].last_seen);
        }
    }
}

TEST(Ply, ReadsOtherOrdersTypesAndUnknownProperties) {
    const TempFolder folder;
    std::string content =
        "ply\r\nformat binary_little_endian 1.0\r\nobj_info made elsewhere\r\nelement vertex 1\r\nproperty double z\r\n"
        "property short quality\r\nproperty float32 y\r\nproperty uint8 blue\r\nproperty float x\r\nelement face 0\r\n"
        "property list uchar int vertex_indices\r\nend_header\r\n";
    append(content, 3.0), append(content, std::int16_t{-5}), append(content, 2.0f), append(content, std::uint8_t{200}),
        append(content, 1.0f);
    const auto read = read_ply(folder.write("m.ply", content));
    ASSERT_EQ(read.size(), 1u);
    EXPECT_EQ(read[0].position, Eigen::Vector3f(1, 2, 3));
    EXPECT_EQ(read[0].color, (Rgb8{0, 0, 200}));
    EXPECT_EQ(read[0].normal, Eigen::Vector3f(0, 0, 0));
}

TEST(Ply, FaultsAreNamed) {
    const TempFolder folder;
    const auto fault = [&](const std::string& content) {
        const auto file = folder.write("m.ply", content);
        return message_of<Error>([&] { (void)read_ply(file); });
    };
    const std::string head = "ply\nformat binary_little_endian 1.0\n",
                      xyz = "property float x\nproperty float y\nproperty float z\n";
    EXPECT_NE(fault("solid cube").find("m.ply"), std::string::npos);
    EXPECT_NE(fault("text\n").find("is not a PLY file"), std::string::npos);
    EXPECT_NE(fault("ply\nformat ascii 1.0\n").find("'ascii'"), std::string::npos);
    EXPECT_NE(fault(head + "element vertex 1\n" + xyz).find("ends within"), std::string::npos);
    EXPECT_NE(fault(head + "element vertex 1\nproperty float x\nend_header\n").find("lack x, y or z"),
              std::string::npos);
    EXPECT_NE(fault(head + "element face 1\nend_header\n").find("expected vertex"), std::string::npos);
    EXPECT_NE(fault(head + "element vertex many\n" + xyz + "end_header\n").find("not a number"), std::string::npos);
    EXPECT_NE(fault(head + "element vertex 1\nproperty list uchar int x\nend_header\n").find("'list'"),
              std::string::npos);
    EXPECT_NE(
        fault(head + "element vertex 5\n" + xyz + "end_header\nxxxx").find("truncated: 5 vertices announced, 0 there"),
        std::string::npos);
    EXPECT_NE(fault(head + "element vertex 4000000000000000000\n" + xyz + "end_header\nxxxx").find("truncated"),
              std::string::npos);
    EXPECT_NE(fault("ply\n" + std::string(100000, 'x')).find("endless header line"), std::string::npos);
    EXPECT_THROW((void)read_ply(folder / "none.ply"), Error);
    EXPECT_THROW((void)read_ply(folder.path()), Error);
}

TEST(Ply, ValuesBeyondTheTargetTypeAreClamped) {
    const TempFolder folder;
    std::string content =
        "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        "property float red\nproperty double created\nproperty int last_seen\nproperty float green\nend_header\n";
    for (const float f : {0.0f, 0.0f, 0.0f, 1e9f}) append(content, f);
    append(content, 1e300), append(content, std::int32_t{-3}), append(content, std::numeric_limits<float>::quiet_NaN());
    const auto read = read_ply(folder.write("m.ply", content));
    EXPECT_EQ(read.at(0).color, (Rgb8{255, 0, 0}));
    EXPECT_EQ(read.at(0).created, 0xFFFFFFFFu);
    EXPECT_EQ(read.at(0).last_seen, 0u);
}

TEST(Ply, AFullDiskIsAnError) { EXPECT_THROW(write_ply("/dev/full", some_surfels(10000)), Error); }

}  // namespace
}  // namespace posefusion
