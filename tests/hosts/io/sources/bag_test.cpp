#include <cmath>
#include <limits>

#include "tests/hosts/io/sources/bag_writer.hpp"
#include "tests/hosts/io/sources/frames.hpp"

namespace posefusion::test {
namespace {

constexpr const char *kColorTopic = "/camera/rgb/image_color", *kDepthTopic = "/camera/depth_registered/image_raw",
                     *kInfoTopic = "/camera/rgb/camera_info";
constexpr const char *kImage = "sensor_msgs/Image", *kCompressed = "sensor_msgs/CompressedImage",
                     *kInfo = "sensor_msgs/CameraInfo";
const std::vector<double> kK{30.25, 0, 15.5, 0, 30.5, 11.125, 0, 0, 1};

template <class Pixels>
std::string bytes_of(const Pixels& image) {
    return {reinterpret_cast<const char*>(image.data()), image.size() * sizeof(*image.data())};
}

struct Stamp {
    explicit Stamp(const RawFrame& frame)
        : seconds(static_cast<std::uint32_t>(std::stoul(frame.stamp_text))),
          nanoseconds(static_cast<std::uint32_t>(std::stoul(frame.stamp_text.substr(frame.stamp_text.find('.') + 1))) *
                      1000) {}
    std::uint32_t seconds, nanoseconds;
};

void add_color(BagWriter& bag, const RawFrame& frame) {
    const Stamp t(frame);
    bag.add(kColorTopic, kImage, t.seconds, t.nanoseconds,
            BagWriter::image(t.seconds, t.nanoseconds, kWidth, kHeight, "rgb8", bytes_of(frame.color)));
}

void add_depth(BagWriter& bag, const RawFrame& frame) {
    const Stamp t(frame);
    bag.add(kDepthTopic, kImage, t.seconds, t.nanoseconds,
            BagWriter::image(t.seconds, t.nanoseconds, kWidth, kHeight, "16UC1", bytes_of(frame.depth)));
}

BagWriter good_bag(const std::string& compression, int frames = 3) {
    BagWriter bag(compression);
    bag.add(kInfoTopic, kInfo, 1, 0, BagWriter::camera_info(kWidth, kHeight, kK));
    for (int i = 0; i < frames; ++i) {
        add_color(bag, make_frame(i));
        add_depth(bag, make_frame(i));
        bag.end_chunk();
    }
    return bag;
}

class Bag : public testing::Test {
protected:
    std::filesystem::path write(const std::string& content) const { return folder.write("a.bag", content); }
    std::string fault(const std::string& content) const { return open_fault(write(content)); }
    TempFolder folder;
};

class BagRoundTrip : public testing::TestWithParam<std::tuple<const char*, bool>> {};

TEST_P(BagRoundTrip, GivesWhatWentIn) {
    const TempFolder folder;
    const auto [compression, closed] = GetParam();
    const auto source = open_source(folder.write("a.bag", good_bag(compression).finish(closed)));
    EXPECT_TRUE(source->facts().warnings.empty()) << source->facts().warnings[0];
    ASSERT_EQ(source->size(), 3u);
    EXPECT_EQ(source->camera().intrinsics.fy, 30.5f);
    EXPECT_EQ(source->camera().intrinsics.cy, 11.125f);
    EXPECT_EQ(source->camera().depth_scale, 1000);
    for (const int i : {2, 0, 1}) expect_same(source->read(static_cast<std::size_t>(i)), make_frame(i));
}
INSTANTIATE_TEST_SUITE_P(All, BagRoundTrip, testing::Combine(testing::Values("none", "bz2", "lz4"), testing::Bool()));

/// Bags made by ROS itself, see data/make_bags.py.
class RosBag : public testing::TestWithParam<const char*> {};

TEST_P(RosBag, IsRead) {
    const auto source = open_source(std::filesystem::path(POSEFUSION_TEST_DATA) / GetParam());
    EXPECT_TRUE(source->facts().warnings.empty());
    ASSERT_EQ(source->size(), 3u);
    const Camera& camera = source->camera();
    EXPECT_EQ(camera.intrinsics.width, 8);
    EXPECT_FLOAT_EQ(camera.intrinsics.fx, 9.5f);
    EXPECT_FLOAT_EQ(camera.intrinsics.cy, 2.5f);
    EXPECT_FLOAT_EQ(camera.distortion[1], -0.2f);
    for (int i = 0; i < 3; ++i) {
        const RawFrame frame = source->read(static_cast<std::size_t>(i));
        EXPECT_NEAR(frame.stamp, 100.5 + i * 0.033333, 1e-9);
        EXPECT_EQ(frame.color(5, 4), (Rgb8{50, 80, static_cast<std::uint8_t>(i)}));
        EXPECT_EQ(frame.depth(5, 4), 1000 + 100 * i + 5 + 40);
    }
}
INSTANTIATE_TEST_SUITE_P(All, RosBag, testing::Values("plain.bag", "bz2.bag", "lz4.bag"));

TEST_F(Bag, FloatDepthIsKeptToAFifthOfAMillimetre) {
    BagWriter bag;
    bag.add(kInfoTopic, kInfo, 1, 0, BagWriter::camera_info(kWidth, kHeight, kK));
    add_color(bag, make_frame(0));
    std::vector<float> metres(kWidth * kHeight, 1.2346f);
    metres[1] = std::numeric_limits<float>::quiet_NaN();
    metres[2] = -1;
    metres[3] = std::numeric_limits<float>::infinity();
    metres[4] = 50;
    const Stamp t(make_frame(0));
    bag.add("/camera/depth/image", kImage, t.seconds, t.nanoseconds,
            BagWriter::image(t.seconds, t.nanoseconds, kWidth, kHeight, "32FC1", bytes_of(metres)));
    const auto source = open_source(write(bag.finish()));
    const DepthImage depth = to_metres(source->read(0).depth, source->camera().depth_scale);
    EXPECT_NEAR(depth[0], 1.2346f, 0.0001f);
    for (const std::size_t i : {1, 2, 3, 4}) EXPECT_EQ(depth[i], 0);
}

TEST_F(Bag, CompressedImagesAreRead) {
    BagWriter bag("lz4");
    const RawFrame frame = make_frame(1);
    const Stamp t(frame);
    bag.add("/cam/color/camera_info", kInfo, 1, 0, BagWriter::camera_info(kWidth, kHeight, kK));
    bag.add(
        "/cam/color/image_raw/compressed", kCompressed, t.seconds, t.nanoseconds,
        BagWriter::compressed_image(t.seconds, t.nanoseconds, "rgb8; png compressed bgr8", encode_png(frame.color)));
    write_raw_depth(folder / "d.png", frame.depth);
    bag.add("/cam/aligned_depth/image_raw/compressedDepth", kCompressed, t.seconds, t.nanoseconds,
            BagWriter::compressed_image(t.seconds, t.nanoseconds, "16UC1; compressedDepth",
                                        std::string(12, '\0') + read_all(folder / "d.png")));
    expect_same(open_source(write(bag.finish()))->read(0), frame);
}

TEST_F(Bag, BytesMayBeInTheOtherOrder) {
    BagWriter bag;
    bag.add(kInfoTopic, kInfo, 1, 0, BagWriter::camera_info(kWidth, kHeight, kK));
    add_color(bag, make_frame(0));
    const Stamp t(make_frame(0));
    std::string swapped = bytes_of(make_frame(0).depth);
    for (std::size_t i = 0; i < swapped.size(); i += 2) std::swap(swapped[i], swapped[i + 1]);
    bag.add(kDepthTopic, kImage, t.seconds, t.nanoseconds,
            BagWriter::image(t.seconds, t.nanoseconds, kWidth, kHeight, "16UC1", swapped, true));
    expect_same(open_source(write(bag.finish()))->read(0), make_frame(0));
}

TEST_F(Bag, TopicsCanBeChosen) {
    BagWriter bag = good_bag("none");
    const RawFrame other = make_frame(9);
    const Stamp t(make_frame(0));
    bag.add("/other/rgb/image", kImage, t.seconds, t.nanoseconds,
            BagWriter::image(t.seconds, t.nanoseconds, kWidth, kHeight, "rgb8", bytes_of(other.color)));
    bag.add("/other/rgb/camera_info", kInfo, 1, 0,
            BagWriter::camera_info(kWidth, kHeight, {20, 0, 1, 0, 20, 1, 0, 0, 1}));
    const auto file = write(bag.finish());
    ASSERT_EQ(open_source(file)->facts().warnings.size(), 1u);
    EXPECT_TRUE(has(open_source(file)->facts().warnings[0], "2 topics may hold colour images"));
    SourceOptions options;
    options.color_topic = "/other/rgb/image";
    const auto source = open_source(file, options);
    EXPECT_EQ(source->size(), 1u);
    EXPECT_EQ(source->camera().intrinsics.fx, 20);
    EXPECT_EQ(source->read(0).color(3, 3), other.color(3, 3));
    options.color_topic = "/nowhere";
    EXPECT_TRUE(has(open_fault(file, options), "has no image topic /nowhere; it has /camera/"));
}

TEST_F(Bag, WhatIsMissingIsNamed) {
    BagWriter no_depth;
    add_color(no_depth, make_frame(0));
    EXPECT_TRUE(has(fault(no_depth.finish()), "has no depth images"));
    BagWriter no_camera;
    add_color(no_camera, make_frame(0));
    add_depth(no_camera, make_frame(0));
    const std::string content = no_camera.finish();
    EXPECT_TRUE(has(fault(content), "holds no camera_info")) << fault(content);
    SourceOptions options;
    options.camera_file = folder / "c.yaml";
    write_camera_file(options.camera_file, test_camera());
    expect_same(open_source(write(content), options)->read(0), make_frame(0));
    BagWriter uncalibrated;
    add_color(uncalibrated, make_frame(0));
    add_depth(uncalibrated, make_frame(0));
    uncalibrated.add(kInfoTopic, kInfo, 1, 0, BagWriter::camera_info(kWidth, kHeight, std::vector<double>(9, 0)));
    EXPECT_TRUE(has(fault(uncalibrated.finish()), "was not calibrated"));
    BagWriter apart;
    add_color(apart, make_frame(0));
    add_depth(apart, make_frame(1));
    EXPECT_TRUE(has(fault(apart.finish()), "within 20 ms"));
    EXPECT_TRUE(has(fault(BagWriter().finish()), "holds no messages"));
}

TEST_F(Bag, OtherFilesAreRefused) {
    EXPECT_TRUE(has(fault(""), "is not a ROS bag"));
    EXPECT_TRUE(has(fault("#ROSBAG V1.2\nxxxxxxx"), "another version"));
    EXPECT_TRUE(has(fault("#ROSBAG V2.0\n"), "holds no messages"));
    EXPECT_TRUE(has(fault("#ROSBAG V2.0\n" + std::string(64, '\xFF')), "damaged"));
    EXPECT_TRUE(has(fault(std::string(5000, 'a')), "is not a ROS bag"));
}

TEST_F(Bag, AnUnclosedBagIsUsedAsFarAsItGoes) {
    const std::string content = good_bag("bz2").finish(false);
    const auto source = open_source(write(content.substr(0, content.size() - 200)));
    EXPECT_EQ(source->size(), 2u);
    ASSERT_FALSE(source->facts().warnings.empty());
    EXPECT_TRUE(has(source->facts().warnings[0], "what comes before is used")) << source->facts().warnings[0];
    expect_same(source->read(1), make_frame(1));
}

/// A chunk of some bytes that claims to have 200 MiB when it is unpacked, and one that really has.
TEST_F(Bag, BombsAreNotUnpacked) {
    const auto bag_with_chunk = [](const std::string& packing, std::uint32_t size, const std::string& data) {
        std::string bag = BagWriter().finish();
        return bag + BagWriter::record(BagWriter::field("op", "\x05") + BagWriter::field("compression", packing) +
                                           BagWriter::field("size", BagWriter::number(size)),
                                       data);
    };
    for (const char* packing : {"bz2", "lz4"})
        EXPECT_TRUE(has(fault(bag_with_chunk(packing, 200U << 20, "tiny")), "claims to be enormous"));
    EXPECT_TRUE(has(fault(bag_with_chunk("none", 0xFFFFFFFF, "tiny")), "is damaged"));
    BagWriter zeros("bz2");
    zeros.add(kColorTopic, kImage, 1, 0, std::string(std::size_t{1} << 26, '\0'));
    std::string bomb = zeros.finish(false);
    const std::size_t size = bomb.find("size=");
    ASSERT_NE(size, std::string::npos);
    bomb.replace(size + 5, 4, BagWriter::number(std::uint32_t{1000}));
    EXPECT_TRUE(has(fault(bomb), "cannot be unpacked")) << fault(bomb);
}

TEST_F(Bag, AbsurdImagesAreRefused) {
    const auto read_fault = [&](const std::string& message) {
        BagWriter bag;
        bag.add(kInfoTopic, kInfo, 1, 0, BagWriter::camera_info(kWidth, kHeight, kK));
        add_color(bag, make_frame(0));
        const Stamp t(make_frame(0));
        bag.add(kDepthTopic, kImage, t.seconds, t.nanoseconds, message);
        const auto file = write(bag.finish());
        return message_of<Error>([&] { (void)open_source(file)->read(0); });
    };
    const Stamp t(make_frame(0));
    const auto image = [&](int w, int h, const char* encoding, std::size_t bytes) {
        return BagWriter::image(t.seconds, t.nanoseconds, w, h, encoding, std::string(bytes, 'x'));
    };
    EXPECT_TRUE(has(read_fault(image(1 << 30, 1 << 30, "16UC1", 64)), "impossible size"));
    EXPECT_TRUE(has(read_fault(image(0, 0, "16UC1", 64)), "impossible size"));
    EXPECT_TRUE(has(read_fault(image(kWidth, kHeight, "16UC1", 64)), "less data than pixels"));
    EXPECT_TRUE(has(read_fault(image(kWidth * 2, kHeight, "16UC1", kWidth * kHeight * 4)), "expected 32x24"));
    EXPECT_TRUE(has(read_fault(image(kWidth, kHeight, "bayer", kWidth * kHeight * 2)), "encoding 'bayer'"));
}

TEST_F(Bag, NoDamageDoesHarm) {
    for (const char* compression : {"none", "bz2", "lz4"})
        expect_no_harm_in_damage(write(good_bag(compression, 1).finish()), compression[0] == 'n' ? 151 : 73);
}

}  // namespace
}  // namespace posefusion::test
