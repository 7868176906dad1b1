#include <cmath>
#include <limits>

#include "tests/hosts/io/sources/bag_writer.hpp"
#include "tests/hosts/io/sources/frames.hpp"
#include "tests/hosts/io/sources/rvl_writer.hpp"

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

struct RosTime {
    explicit RosTime(const RawFrame& frame)
        : seconds(static_cast<std::uint32_t>(std::stoul(frame.stamp_text))),
          nanoseconds(static_cast<std::uint32_t>(std::stoul(frame.stamp_text.substr(frame.stamp_text.find('.') + 1))) *
                      1000) {}
    RosTime(std::uint32_t s, std::uint32_t ns) : seconds(s), nanoseconds(ns) {}
    std::uint32_t seconds, nanoseconds;
};

/// @param header  what the driver writes as the time of the image
void add_color(BagWriter& bag, const RawFrame& frame, const RosTime& header) {
    const RosTime t(frame);
    bag.add(kColorTopic, kImage, t.seconds, t.nanoseconds,
            BagWriter::image(header.seconds, header.nanoseconds, kWidth, kHeight, "rgb8", bytes_of(frame.color)));
}

void add_color(BagWriter& bag, const RawFrame& frame) { add_color(bag, frame, RosTime(frame)); }

void add_depth(BagWriter& bag, const RawFrame& frame, const RosTime& header) {
    const RosTime t(frame);
    bag.add(kDepthTopic, kImage, t.seconds, t.nanoseconds,
            BagWriter::image(header.seconds, header.nanoseconds, kWidth, kHeight, "16UC1", bytes_of(frame.depth)));
}

void add_depth(BagWriter& bag, const RawFrame& frame) { add_depth(bag, frame, RosTime(frame)); }

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
        EXPECT_NEAR(to_seconds(frame.stamp), 100.5 + i * 0.033333, 1e-9);
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
    const RosTime t(make_frame(0));
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
    const RosTime t(frame);
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
    const RosTime t(make_frame(0));
    std::string swapped = bytes_of(make_frame(0).depth);
    for (std::size_t i = 0; i < swapped.size(); i += 2) std::swap(swapped[i], swapped[i + 1]);
    bag.add(kDepthTopic, kImage, t.seconds, t.nanoseconds,
            BagWriter::image(t.seconds, t.nanoseconds, kWidth, kHeight, "16UC1", swapped, true));
    expect_same(open_source(write(bag.finish()))->read(0), make_frame(0));
}

TEST_F(Bag, TopicsCanBeChosen) {
    BagWriter bag = good_bag("none");
    const RawFrame other = make_frame(9);
    const RosTime t(make_frame(0));
    bag.add("/other/rgb/image", kImage, t.seconds, t.nanoseconds,
            BagWriter::image(t.seconds, t.nanoseconds, kWidth, kHeight, "rgb8", bytes_of(other.color)));
    bag.add("/other/rgb/camera_info", kInfo, 1, 0,
            BagWriter::camera_info(kWidth, kHeight, {20, 0, 1, 0, 20, 1, 0, 0, 1}));
    const auto file = write(bag.finish());
    ASSERT_EQ(open_source(file)->facts().warnings.size(), 1u);
    EXPECT_TRUE(has(open_source(file)->facts().warnings[0],
                    "colour is taken from /camera/rgb/image_color (rgb8, 32x24), depth from "
                    "/camera/depth_registered/image_raw (16UC1, 32x24); not from /other/rgb/image (rgb8, 32x24)"))
        << open_source(file)->facts().warnings[0];
    SourceOptions options;
    options.color_topic = "/other/rgb/image";
    const auto source = open_source(file, options);
    EXPECT_EQ(source->size(), 1u);
    EXPECT_EQ(source->camera().intrinsics.fx, 20);
    EXPECT_EQ(source->read(0).color(3, 3), other.color(3, 3));
    options.color_topic = "/nowhere";
    EXPECT_TRUE(has(open_fault(file, options), "has no image topic /nowhere; it has /camera/"));
}

class BagWithoutHeaderTimes : public Bag, public testing::WithParamInterface<std::pair<bool, bool>> {};

/// Some drivers leave the stamps of the headers at 0.
TEST_P(BagWithoutHeaderTimes, IsReadByTheTimesOfRecording) {
    const auto [color_unset, depth_unset] = GetParam();
    BagWriter bag;
    bag.add(kInfoTopic, kInfo, 1, 0, BagWriter::camera_info(kWidth, kHeight, kK));
    for (int i = 0; i < 12; ++i) {
        const RawFrame frame = make_frame(i);
        add_color(bag, frame, color_unset ? RosTime(0, 0) : RosTime(frame));
        add_depth(bag, frame, depth_unset ? RosTime(0, 0) : RosTime(frame));
    }
    const auto source = open_source(write(bag.finish()));
    ASSERT_EQ(source->size(), 12u);
    for (const int i : {0, 5, 11}) expect_same(source->read(static_cast<std::size_t>(i)), make_frame(i));
    ASSERT_EQ(source->facts().warnings.size(), 1u);
    EXPECT_TRUE(has(source->facts().warnings[0], "are all alike; the times of recording are used instead"))
        << source->facts().warnings[0];
}
INSTANTIATE_TEST_SUITE_P(All, BagWithoutHeaderTimes,
                         testing::Values(std::pair{true, true}, std::pair{true, false}, std::pair{false, true}));

TEST_F(Bag, ClocksOfTwoDevicesAreReplacedByTheTimesOfRecording) {
    BagWriter bag;
    bag.add(kInfoTopic, kInfo, 1, 0, BagWriter::camera_info(kWidth, kHeight, kK));
    for (int i = 0; i < 3; ++i) {
        add_color(bag, make_frame(i));
        add_depth(bag, make_frame(i), RosTime(static_cast<std::uint32_t>(7 + i), 0));
    }
    const auto source = open_source(write(bag.finish()));
    ASSERT_EQ(source->size(), 3u);
    expect_same(source->read(2), make_frame(2));
    EXPECT_TRUE(has(source->facts().warnings[0], "the times of recording are used instead"));
}

TEST_F(Bag, SingleMessagesWithoutATimeAreCountedAndTold) {
    BagWriter bag;
    bag.add(kInfoTopic, kInfo, 1, 0, BagWriter::camera_info(kWidth, kHeight, kK));
    for (int i = 0; i < 6; ++i) {
        add_color(bag, make_frame(i), i < 2 ? RosTime(0, 0) : RosTime(make_frame(i == 4 ? 3 : i)));
        add_depth(bag, make_frame(i));
    }
    const auto source = open_source(write(bag.finish()));
    ASSERT_EQ(source->size(), 3u);
    expect_same(source->read(0), make_frame(2));
    ASSERT_EQ(source->facts().warnings.size(), 2u);
    EXPECT_TRUE(has(source->facts().warnings[0], "2 messages without a time stamp left out"));
    EXPECT_TRUE(has(source->facts().warnings[1], "1 message with a time stamp that was there before left out"));
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
        const RosTime t(make_frame(0));
        bag.add(kDepthTopic, kImage, t.seconds, t.nanoseconds, message);
        const auto file = write(bag.finish());
        return message_of<Error>([&] { (void)open_source(file)->read(0); });
    };
    const RosTime t(make_frame(0));
    const auto image = [&](int w, int h, const char* encoding, std::size_t bytes) {
        return BagWriter::image(t.seconds, t.nanoseconds, w, h, encoding, std::string(bytes, 'x'));
    };
    EXPECT_TRUE(has(read_fault(image(1 << 30, 1 << 30, "16UC1", 64)), "impossible size"));
    EXPECT_TRUE(has(read_fault(image(0, 0, "16UC1", 64)), "impossible size"));
    EXPECT_TRUE(has(read_fault(image(kWidth, kHeight, "16UC1", 64)), "less data than pixels"));
    EXPECT_TRUE(has(read_fault(image(kWidth * 2, kHeight, "16UC1", kWidth * kHeight * 4)), "not of one camera"));
    EXPECT_TRUE(has(read_fault(image(kWidth, kHeight, "bayer", kWidth * kHeight * 2)), "encoding 'bayer'"));
    EXPECT_TRUE(has(read_fault(image(kWidth, kHeight, "mono8", kWidth * kHeight)), "pictures of depth"));
}

/// One topic of images of a bag that is made up, and how it is recorded.
struct Images {
    const char *topic, *encoding, *frame_id;
    int width, height;
    double fx;  ///< of its camera_info, in the folder above; 0: it has none
};

/// A bag of one message on each of these topics, all at one time. The images are black, the depth 1 + i m, i being the
/// place in the list.
std::string bag_of(const std::vector<Images>& topics, const char* info_name = "camera_info") {
    BagWriter bag;
    for (std::size_t i = 0; i < topics.size(); ++i) {
        const Images& t = topics[i];
        const std::string encoding = t.encoding,
                          folder = std::string(t.topic).substr(0, std::string(t.topic).rfind('/'));
        const auto pixels = static_cast<std::size_t>(t.width) * static_cast<std::size_t>(t.height);
        std::string data;
        if (encoding == "32FC1") {
            data = bytes_of(std::vector<float>(pixels, static_cast<float>(i + 1)));
        } else if (encoding == "16UC1" || encoding == "mono16") {
            data = bytes_of(std::vector<std::uint16_t>(pixels, static_cast<std::uint16_t>(1000 * (i + 1))));
        } else {
            data.resize(pixels * (encoding == "rgb8" ? 3 : encoding == "bgra8" ? 4 : 1));
        }
        bag.add(t.topic, kImage, 5, 0, BagWriter::image(5, 0, t.width, t.height, encoding, data, false, t.frame_id));
        if (t.fx > 0) {
            const std::string name = std::string(info_name).starts_with('/')
                                         ? folder.substr(0, folder.rfind('/')) + info_name
                                         : folder + "/" + info_name;
            bag.add(
                name, kInfo, 5, 0,
                BagWriter::camera_info(t.width, t.height, {t.fx, 0, t.width / 2.0, 0, t.fx, t.height / 2.0, 0, 0, 1},
                                       {}, "plumb_bob", t.frame_id));
        }
    }
    return bag.finish();
}

/// Depth in metres in the middle of the first frame.
float middle(const FrameSource& source) {
    const DepthImage depth = to_metres(source.read(0).depth, source.camera().depth_scale);
    return depth(depth.width() / 2, depth.height() / 2);
}

TEST_F(Bag, RegisteredDepthGoesBeforeRawDepthWhateverItsName) {
    // Named alike, and the raw one first; size, frame and camera tell.
    for (const auto& [raw, registered] :
         {std::pair{"/camera/depth/image_raw", "/camera/depth_registered/image_raw"},
          std::pair{"/camera/depth/image_raw", "/camera/extra/depth"}, std::pair{"/a/depth/image", "/b/depth/image"}}) {
        const auto source = open_source(write(bag_of({{raw, "16UC1", "depth_frame", 32, 24, 29},
                                                      {registered, "16UC1", "rgb_frame", 32, 24, 31},
                                                      {"/camera/rgb/image_color", "rgb8", "rgb_frame", 32, 24, 31}})));
        EXPECT_FLOAT_EQ(middle(*source), 2) << registered;
        ASSERT_EQ(source->facts().warnings.size(), 1u) << registered;
        EXPECT_TRUE(has(source->facts().warnings[0], std::string("not from ") + raw)) << source->facts().warnings[0];
    }
}

TEST_F(Bag, OfAnAzureKinectIsReadByTheDepthOfTheSizeOfColour) {
    const auto source =
        open_source(write(bag_of({{"/depth/image_raw", "16UC1", "depth_camera_link", 20, 18, 16},
                                  {"/depth_to_rgb/image_raw", "16UC1", "rgb_camera_link", 64, 36, 30},
                                  {"/ir/image_raw", "mono16", "depth_camera_link", 20, 18, 16},
                                  {"/rgb/image_raw", "bgra8", "rgb_camera_link", 64, 36, 30},
                                  {"/rgb_to_depth/image_raw", "bgra8", "depth_camera_link", 20, 18, 16}})));
    EXPECT_EQ(source->camera().intrinsics.width, 64);
    EXPECT_FLOAT_EQ(source->camera().intrinsics.fx, 30);
    EXPECT_FLOAT_EQ(middle(*source), 2);
}

TEST_F(Bag, NamespacesSayNothing) {
    const auto source =
        open_source(write(bag_of({{"/depth_camera/rgb/image_raw", "rgb8", "c", 32, 24, 31},
                                  {"/depth_camera/depth_registered/image_raw", "32FC1", "c", 32, 24, 31}})));
    EXPECT_FLOAT_EQ(middle(*source), 2);
    EXPECT_EQ(source->read(0).color.width(), 32);
    EXPECT_TRUE(source->facts().warnings.empty()) << source->facts().warnings[0];
}

TEST_F(Bag, InfraredIsNoDepthThoughItIsEncodedAlike) {
    const auto source =
        open_source(write(bag_of({{"/camera/ir/image_raw", "16UC1", "ir", 32, 24, 31},
                                  {"/camera/infra1/image_rect_raw", "mono8", "ir", 32, 24, 31},
                                  {"/camera/color/image_raw", "rgb8", "rgb", 32, 24, 31},
                                  {"/camera/aligned_depth_to_color/image_raw", "16UC1", "rgb", 32, 24, 31}})));
    EXPECT_FLOAT_EQ(middle(*source), 4);
}

TEST_F(Bag, OfTwoCamerasColourAndDepthAreOfOne) {
    const auto source =
        open_source(write(bag_of({{"/cam1/color/image_raw", "rgb8", "c1", 32, 24, 31},
                                  {"/cam2/color/image_raw", "rgb8", "c2", 32, 24, 33},
                                  {"/cam2/aligned_depth_to_color/image_raw", "16UC1", "c2", 32, 24, 33}})));
    EXPECT_FLOAT_EQ(source->camera().intrinsics.fx, 33);
}

/// RealSense's viewer: depth of its own camera, as mono16 in units that an option tells, 5 cm beside colour.
TEST_F(Bag, OfRealSenseViewerIsRegistered) {
    const std::string depth = "/device_0/sensor_0/Depth_0", color = "/device_0/sensor_1/Color_0";
    BagWriter bag;
    const auto add = [&](const std::string& stream, const char* encoding, int width, int height, double f, double x,
                         const std::string& data) {
        bag.add(stream + "/info/camera_info", kInfo, 0, 0,
                BagWriter::camera_info(width, height, {f, 0, (width - 1) / 2.0, 0, f, (height - 1) / 2.0, 0, 0, 1}, {},
                                       "Brown Conrady", ""));
        bag.add(stream + "/tf/0", "geometry_msgs/Transform", 0, 0, bytes_of(std::vector<double>{x, 0, 0, 0, 0, 0, 1}));
        bag.add(stream + "/image/data", kImage, 5, 0, BagWriter::image(5, 0, width, height, encoding, data, false, ""));
    };
    add(depth, "mono16", 48, 36, 40, 0, bytes_of(std::vector<std::uint16_t>(48 * 36, 5000)));
    add(color, "rgb8", 64, 48, 80, 0.05, std::string(64 * 48 * 3, 'c'));
    add("/device_0/sensor_0/Infrared_1", "8UC1", 48, 36, 40, 0, std::string(48 * 36, 'i'));
    bag.add("/device_0/sensor_0/option/Depth_Units/value", "std_msgs/Float32", 0, 0,
            bytes_of(std::vector<float>{0.0001f}));
    const auto source = open_source(write(bag.finish()));
    EXPECT_FLOAT_EQ(source->camera().intrinsics.fx, 80);
    EXPECT_NEAR(source->camera().depth_scale, 10000, 0.01);
    const RawFrame frame = source->read(0);
    ASSERT_EQ(frame.depth.width(), 64);
    const DepthImage metres = to_metres(frame.depth, source->camera().depth_scale);
    EXPECT_NEAR(metres(32, 24), 0.5f, 1e-4f);
    // The depth image ends at x = -24/40 * 0.5 m = -0.3 m, which colour sees 5 cm farther right:
    // 31.5 + 80 * (-0.3 + 0.05) / 0.5 = -8.5 and, on the other side, 31.5 + 80 * (0.3 + 0.05) / 0.5 = 87.5.
    for (int u = 0; u < 64; ++u) EXPECT_NEAR(metres(u, 24), 0.5f, 1e-4f) << u;
    const auto& warnings = source->facts().warnings;
    ASSERT_FALSE(warnings.empty());
    EXPECT_TRUE(has(warnings.back(), "it is registered by " + depth + "/info/camera_info and the transform between"))
        << warnings.back();
}

/// Depth and colour of two cameras that /tf_static joins over the body of the device.
TEST_F(Bag, RawDepthIsRegisteredByItsCameraAndTf) {
    const auto with_tf = [&](bool tf) {
        BagWriter bag;
        const auto add = [&](const std::string& name, const char* encoding, double f, const char* frame,
                             const std::string& data) {
            bag.add("/cam/" + name + "/camera_info", kInfo, 5, 0,
                    BagWriter::camera_info(32, 24, {f, 0, 15.5, 0, f, 11.5, 0, 0, 1}, {}, "plumb_bob", frame));
            bag.add("/cam/" + name + "/image_raw", kImage, 5, 0,
                    BagWriter::image(5, 0, 32, 24, encoding, data, false, frame));
        };
        std::vector<std::uint16_t> depth(32 * 24, 2000);
        for (std::size_t i = 0; i < depth.size(); ++i)
            if (i % 32 < 16) depth[i] = 0;                            // nothing on the left
        add("depth", "16UC1", 20.2, "depth_frame", bytes_of(depth));  // another camera than that of colour
        add("rgb", "rgb8", 20, "rgb_frame", std::string(32 * 24 * 3, 'c'));
        if (tf)  // body -> rgb at x = 0.6, body -> depth at x = 0.4: depth is 0.2 m left of rgb, 2 pixels at 2 m
            bag.add("/tf_static", "tf2_msgs/TFMessage", 5, 0,
                    BagWriter::transforms({{"body", "/rgb_frame", 0.6}, {"body", "depth_frame", 0.4}}));
        return open_source(write(bag.finish()));
    };
    const auto first_measured = [](const FrameSource& source) {
        const RawDepth depth = source.read(0).depth;
        int u = 0;
        while (u < 32 && depth(u, 12) == 0) ++u;
        return u;
    };
    const auto joined = with_tf(true);
    EXPECT_EQ(first_measured(*joined), 14);
    EXPECT_TRUE(has(joined->facts().warnings.back(), "and the transform between the cameras"));
    const auto alone = with_tf(false);
    EXPECT_EQ(first_measured(*alone), 16);
    EXPECT_TRUE(has(alone->facts().warnings.back(), "as if both cameras were at one place"));
}

TEST_F(Bag, DepthOfAnotherSizeIsScaledWhenItIsOfTheSameCamera) {
    const auto source = open_source(
        write(bag_of({{"/rgb/image", "rgb8", "c", 64, 48, 60}, {"/depth/image", "16UC1", "c", 16, 12, 0}})));
    EXPECT_EQ(source->read(0).depth.width(), 64);
    for (const std::uint16_t d : source->read(0).depth) EXPECT_EQ(d, 2000);
    ASSERT_EQ(source->facts().warnings.size(), 1u);
    EXPECT_TRUE(has(source->facts().warnings[0], "taken to be of one camera")) << source->facts().warnings[0];
}

TEST_F(Bag, RectifiedImagesHaveTheProjectionMatrixForCamera) {
    BagWriter bag;
    const auto add = [&](const char* topic, const char* encoding, const std::string& data) {
        bag.add(topic, kImage, 5, 0, BagWriter::image(5, 0, 32, 24, encoding, data));
    };
    bag.add("/rgb/camera_info", kInfo, 5, 0,
            BagWriter::camera_info(32, 24, kK, {0.1, 0, 0, 0, 0}, "plumb_bob", "camera", 28.5));
    add("/rgb/image_rect_color", "rgb8", std::string(32 * 24 * 3, 'c'));
    add("/depth/image", "16UC1", bytes_of(std::vector<std::uint16_t>(32 * 24, 2000)));
    EXPECT_FLOAT_EQ(open_source(write(bag.finish()))->camera().intrinsics.fx, 28.5f);
    EXPECT_FALSE(open_source(folder / "a.bag")->camera().distorted());
}

TEST_F(Bag, LensModels) {
    const auto camera_of = [&](const std::vector<double>& D, const char* model) {
        BagWriter bag;
        bag.add(kInfoTopic, kInfo, 1, 0, BagWriter::camera_info(kWidth, kHeight, kK, D, model));
        add_color(bag, make_frame(0));
        add_depth(bag, make_frame(0));
        return write(bag.finish());
    };
    const std::vector<double> rational{0.5, -2.7, 0.0006, -0.0002, 1.58, 0.39, -2.53, 1.51};
    EXPECT_EQ(open_source(camera_of(rational, "rational_polynomial"))->camera().distortion,
              (LensCoefficients{0.5f, -2.7f, 0.0006f, -0.0002f, 1.58f, 0.39f, -2.53f, 1.51f}));
    EXPECT_TRUE(has(open_fault(camera_of({0.1, 0, 0, 0}, "equidistant")), "undistort the images beforehand"));
    EXPECT_EQ(open_fault(camera_of({0, 0, 0, 0}, "equidistant")), "") << "no distortion, whatever the model";
    const auto unknown = open_source(camera_of({0.1, 0, 0, 0, 0}, "Inverse Brown Conrady"));
    EXPECT_FALSE(unknown->camera().distorted());
    EXPECT_TRUE(has(unknown->facts().warnings.at(0), "is not known and not undone"));
}

/// A red, a green and a blue surface through the filters of the sensor.
TEST_F(Bag, BayerPatternsAreConverted) {
    const Rgb8 color{200, 100, 50};
    for (const std::string pattern : {"rggb", "bggr", "gbrg", "grbg"}) {
        std::string data(kWidth * kHeight, '\0');
        for (int v = 0; v < kHeight; ++v)
            for (int u = 0; u < kWidth; ++u) {
                const char filter = pattern[static_cast<std::size_t>(2 * (v % 2) + u % 2)];
                const int value = filter == 'r' ? color.r : filter == 'g' ? color.g : color.b;
                data[static_cast<std::size_t>(v * kWidth + u)] = static_cast<char>(value);
            }
        BagWriter bag;
        bag.add(kInfoTopic, kInfo, 1, 0, BagWriter::camera_info(kWidth, kHeight, kK));
        const RosTime t(make_frame(0));
        bag.add(kColorTopic, kImage, t.seconds, t.nanoseconds,
                BagWriter::image(t.seconds, t.nanoseconds, kWidth, kHeight, "bayer_" + pattern + "8", data));
        add_depth(bag, make_frame(0));
        EXPECT_EQ(open_source(write(bag.finish()))->read(0).color(9, 9), color) << pattern;
    }
}

TEST_F(Bag, YuvIsConverted) {
    // BT.601, video levels, of (200, 100, 50): Y = 122, U = 91, V = 175
    const std::string u = "\x5B", y = "\x7A", v = "\xAF";
    for (const auto& [encoding, pair] : {std::pair<std::string, std::string>{"yuv422", u + y + v + y},
                                         {"yuv422_yuy2", y + u + y + v},
                                         {"YUYV", y + u + y + v},
                                         {"UYVY", u + y + v + y}}) {
        std::string data;
        for (int i = 0; i < kWidth * kHeight / 2; ++i) data += pair;
        BagWriter bag;
        bag.add(kInfoTopic, kInfo, 1, 0, BagWriter::camera_info(kWidth, kHeight, kK));
        const RosTime t(make_frame(0));
        bag.add(kColorTopic, kImage, t.seconds, t.nanoseconds,
                BagWriter::image(t.seconds, t.nanoseconds, kWidth, kHeight, encoding, data));
        add_depth(bag, make_frame(0));
        const Rgb8 c = open_source(write(bag.finish()))->read(0).color(9, 9);
        EXPECT_NEAR(c.r, 200, 4) << encoding;
        EXPECT_NEAR(c.g, 100, 4) << encoding;
        EXPECT_NEAR(c.b, 50, 4) << encoding;
    }
}

/// Depth as compressed_depth_image_transport packs it.
class CompressedDepth : public Bag {
protected:
    /// @param packed  what comes after the header of the transport
    std::unique_ptr<FrameSource> open(const std::string& format, const std::string& packed, float A = 0,
                                      float B = 0) const {
        BagWriter bag;
        bag.add(kInfoTopic, kInfo, 1, 0, BagWriter::camera_info(kWidth, kHeight, kK));
        add_color(bag, make_frame(0));
        const RosTime t(make_frame(0));
        bag.add("/camera/depth_registered/image_raw/compressedDepth", kCompressed, t.seconds, t.nanoseconds,
                BagWriter::compressed_image(
                    t.seconds, t.nanoseconds, format,
                    BagWriter::number(std::int32_t{0}) + BagWriter::number(A) + BagWriter::number(B) + packed));
        return open_source(write(bag.finish()));
    }
    static std::string rvl(const RawDepth& depth) {
        const ByteBuffer stream = encode_rvl(depth);
        return BagWriter::number(static_cast<std::uint32_t>(depth.width())) +
               BagWriter::number(static_cast<std::uint32_t>(depth.height())) +
               std::string(stream.begin(), stream.end());
    }
    std::string png(const RawDepth& depth) const {
        write_raw_depth(folder / "d.png", depth);
        return read_all(folder / "d.png");
    }
};

TEST_F(CompressedDepth, RvlIsExact) {
    expect_same(open("16UC1; compressedDepth rvl", rvl(make_frame(0).depth))->read(0), make_frame(0));
}

TEST_F(CompressedDepth, FloatIsQuantisedInverseDepth) {
    // As the transport does it: inverse = A / depth + B, rounded; A = 100 * (100 + 1), B = 1 - A / 10 (a range of 10
    // m).
    const float A = 100.0f * 101.0f, B = 1.0f - A / 10.0f;
    RawDepth inverse(kWidth, kHeight);
    DepthImage metres(kWidth, kHeight);
    for (std::size_t i = 0; i < metres.size(); ++i) {
        metres[i] = i % 7 == 0 ? 0 : 0.5f + 0.01f * static_cast<float>(i);
        if (metres[i] > 0) inverse[i] = static_cast<std::uint16_t>(std::lround(A / metres[i] + B));
    }
    for (const auto& [format, packed] :
         {std::pair<std::string, std::string>{"32FC1; compressedDepth png", png(inverse)},
          {"32FC1; compressedDepth", png(inverse)},
          {"32FC1; compressedDepth rvl", rvl(inverse)}}) {
        const auto source = open(format, packed, A, B);
        const DepthImage read = to_metres(source->read(0).depth, source->camera().depth_scale);
        for (std::size_t i = 0; i < metres.size(); ++i)
            ASSERT_NEAR(read[i], metres[i], 0.0001f + metres[i] * metres[i] / A) << format << ", pixel " << i;
    }
}

TEST_F(CompressedDepth, DamagedRvlIsNamed) {
    const std::string good = rvl(make_frame(0).depth);
    const auto fault = [&](const std::string& packed) {
        return message_of<Error>([&] { (void)open("16UC1; compressedDepth rvl", packed)->read(0); });
    };
    EXPECT_EQ(fault(good), "");
    EXPECT_TRUE(has(fault(good.substr(0, good.size() - 8)), "RVL depth ends early"));
    EXPECT_TRUE(has(fault(good.substr(0, 6)), "ends within a record"));
    EXPECT_TRUE(has(fault(BagWriter::number(std::uint32_t{1} << 30) + good.substr(4)), "impossible size"));
}

TEST_F(Bag, NoDamageDoesHarm) {
    for (const char* compression : {"none", "bz2", "lz4"})
        expect_no_harm_in_damage(write(good_bag(compression, 1).finish()), compression[0] == 'n' ? 151 : 73);
}

}  // namespace
}  // namespace posefusion::test
