#include "hosts/io/image_file.hpp"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <utility>
#include <vector>

#include "engine/core/error.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

using test::message_of;
using test::read_all;
using test::TempFolder;

constexpr ImageSize kSize{24, 16};

ColorImage ramp() {
    ColorImage image(kSize.width, kSize.height);
    for (int v = 0; v < kSize.height; ++v)
        for (int u = 0; u < kSize.width; ++u)
            image(u, v) = {static_cast<std::uint8_t>(10 * u), static_cast<std::uint8_t>(12 * v), 77};
    return image;
}

std::string big_endian(std::uint32_t value) {
    return {static_cast<char>(value >> 24), static_cast<char>(value >> 16), static_cast<char>(value >> 8),
            static_cast<char>(value)};
}

TEST(ColorFile, PngIsExactAndKeepsTheChannelOrder) {
    const TempFolder folder;
    write_png(folder / "a.png", ramp());
    const ColorImage image = read_color(folder / "a.png", kSize);
    for (std::size_t i = 0; i < image.size(); ++i) ASSERT_EQ(image[i], ramp()[i]) << i;
    EXPECT_EQ(image_file_size(folder / "a.png"), kSize);
}

TEST(ColorFile, JpegIsCloseAndKeepsTheChannelOrder) {
    const TempFolder folder;
    write_jpeg(folder / "a.jpg", ColorImage(kSize.width, kSize.height, {200, 100, 50}), 95);
    const Rgb8 c = read_color(folder / "a.jpg", kSize)(5, 5);
    EXPECT_NEAR(c.r, 200, 3);
    EXPECT_NEAR(c.g, 100, 3);
    EXPECT_NEAR(c.b, 50, 3);
    EXPECT_EQ(image_file_size(folder / "a.jpg"), kSize);
}

TEST(ColorFile, GreyImagesAreColourImagesToo) {
    const TempFolder folder;
    write_labels(folder / "grey.png", LabelImage(kSize.width, kSize.height, 90));
    EXPECT_EQ(read_color(folder / "grey.png", kSize)(3, 3), (Rgb8{90, 90, 90}));
}

TEST(DepthFile, IsInMetresWithZeroForNoMeasurement) {
    const TempFolder folder;
    DepthImage depth(kSize.width, kSize.height, 1.5f);
    depth(0, 0) = 0;
    depth(1, 0) = 0.0002f;
    depth(2, 0) = 13.0f;  // 65000
    depth(3, 0) = 20.0f;  // does not fit
    write_depth(folder / "d.png", depth, 5000);
    const DepthImage read = read_depth(folder / "d.png", kSize, 5000);
    EXPECT_EQ(read(0, 0), 0);
    EXPECT_FLOAT_EQ(read(1, 0), 0.0002f);
    EXPECT_FLOAT_EQ(read(2, 0), 13.0f);
    EXPECT_EQ(read(3, 0), 0);
    EXPECT_FLOAT_EQ(read(5, 5), 1.5f);
    EXPECT_FLOAT_EQ(read_depth(folder / "d.png", kSize, 1000)(5, 5), 7.5f);
}

TEST(DepthFile, TheLargestValueMeansNoMeasurement) {
    const TempFolder folder;
    cv::imwrite((folder / "d.png").string(), cv::Mat(kSize.height, kSize.width, CV_16UC1, cv::Scalar(65535)));
    EXPECT_EQ(read_depth(folder / "d.png", kSize, 1000)(2, 2), 0);
}

TEST(LabelFile, RoundTrip) {
    const TempFolder folder;
    LabelImage labels(kSize.width, kSize.height);
    labels(3, 4) = 1;
    labels(4, 3) = 15;
    write_labels(folder / "m.png", labels);
    const LabelImage read = read_labels(folder / "m.png", kSize);
    EXPECT_TRUE(std::equal(read.begin(), read.end(), labels.begin()));
    EXPECT_THROW((void)read_labels(folder / "m.png", {48, 32}), Error);
}

/// The same pixels in every format for colour that is lossless.
class LosslessColor : public testing::TestWithParam<const char*> {};

TEST_P(LosslessColor, IsExact) {
    const TempFolder folder;
    const std::string file = (folder / GetParam()).string();
    cv::Mat bgr(kSize.height, kSize.width, CV_8UC3);
    for (int v = 0; v < kSize.height; ++v)
        for (int u = 0; u < kSize.width; ++u) bgr.at<cv::Vec3b>(v, u) = {77, ramp()(u, v).g, ramp()(u, v).r};
    ASSERT_TRUE(cv::imwrite(file, bgr, {cv::IMWRITE_WEBP_QUALITY, 101}));  // above 100: lossless
    EXPECT_EQ(image_file_size(file), kSize);
    const ColorImage image = read_color(file, kSize);
    for (std::size_t i = 0; i < image.size(); ++i) ASSERT_EQ(image[i], ramp()[i]) << i;
    EXPECT_NE(message_of<Error>([&] { (void)read_raw_depth(file, kSize); }).find("is not a 16-bit grey image"),
              std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(All, LosslessColor, testing::Values("a.png", "a.tiff", "a.bmp", "a.ppm", "a.webp"),
                         [](const auto& test) { return std::string(test.param).substr(2); });

TEST(ColorFile, LossyWebPIsClose) {
    const TempFolder folder;
    const std::string file = (folder / "a.webp").string();
    cv::imwrite(file, cv::Mat(kSize.height, kSize.width, CV_8UC3, cv::Scalar(50, 100, 200)),
                {cv::IMWRITE_WEBP_QUALITY, 90});
    EXPECT_EQ(image_file_size(file), kSize);
    EXPECT_NEAR(read_color(file, kSize)(5, 5).r, 200, 4);
}

TEST(ColorFile, GreyTiffAndPgmAreGrey) {
    const TempFolder folder;
    for (const char* name : {"a.tiff", "a.pgm", "a.bmp"}) {
        cv::imwrite((folder / name).string(), cv::Mat(kSize.height, kSize.width, CV_8UC1, cv::Scalar(90)));
        EXPECT_EQ(read_color(folder / name, kSize)(3, 3), (Rgb8{90, 90, 90})) << name;
    }
    folder.write("dim.pgm", "P5\n# of a thermal camera\n2 1 100\n" + std::string{'\x64', '\x32'});
    EXPECT_EQ(read_color(folder / "dim.pgm", {2, 1})(0, 0).r, 255);
    EXPECT_EQ(read_color(folder / "dim.pgm", {2, 1})(1, 0).r, 128);
}

class ShortDepth : public testing::TestWithParam<const char*> {};

TEST_P(ShortDepth, IsExact) {
    const TempFolder folder;
    const std::string file = (folder / GetParam()).string();
    cv::Mat values(kSize.height, kSize.width, CV_16UC1);
    for (int v = 0; v < kSize.height; ++v)
        for (int u = 0; u < kSize.width; ++u) values.at<std::uint16_t>(v, u) = static_cast<std::uint16_t>(2723 * u + v);
    ASSERT_TRUE(cv::imwrite(file, values));
    const RawDepth depth = read_raw_depth(file, kSize);
    for (int v = 0; v < kSize.height; ++v)
        for (int u = 0; u < kSize.width; ++u) ASSERT_EQ(depth(u, v), values.at<std::uint16_t>(v, u));
    EXPECT_NE(message_of<Error>([&] { (void)read_color(file, kSize); }).find("is a 16-bit image"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(All, ShortDepth, testing::Values("d.png", "d.tiff", "d.pgm"),
                         [](const auto& test) { return std::string(test.param).substr(2); });

/// What renderers write: metres in floating point. @param channel  of an EXR
void write_exr(const std::string& file, const DepthImage& depth, const char* channel) {
    Imf::Header header(depth.width(), depth.height());
    header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
    Imf::OutputFile out(file.c_str(), header);
    Imf::FrameBuffer frame;
    frame.insert(channel, Imf::Slice::Make(Imf::FLOAT, depth.data(), header.dataWindow()));
    out.setFrameBuffer(frame);
    out.writePixels(depth.height());
}

TEST(FloatDepth, IsKeptToAFifthOfAMillimetre) {
    const TempFolder folder;
    DepthImage metres(kSize.width, kSize.height, 1.2346f);
    metres(1, 0) = std::nanf("");
    metres(2, 0) = -1;
    metres(3, 0) = std::numeric_limits<float>::infinity();
    metres(4, 0) = 50;  // too far
    metres(5, 0) = 13.1f;
    const cv::Mat values(kSize.height, kSize.width, CV_32FC1, metres.data());
    ASSERT_TRUE(cv::imwrite((folder / "d.tiff").string(), values));
    ASSERT_TRUE(cv::imwrite((folder / "y.exr").string(), values));
    write_exr((folder / "z.exr").string(), metres, "Z");
    write_exr((folder / "blender.exr").string(), metres, "ViewLayer.Depth.Z");
    write_exr((folder / "one.exr").string(), metres, "distance");
    for (const char* name : {"d.tiff", "y.exr", "z.exr", "blender.exr", "one.exr"}) {
        EXPECT_EQ(image_file_size(folder / name), kSize) << name;
        EXPECT_TRUE(image_file_header(folder / name).is_float) << name;
        const DepthImage depth = to_metres(read_raw_depth(folder / name, kSize), kFloatDepthScale);
        EXPECT_NEAR(depth(0, 0), 1.2346f, 0.0001f) << name;
        for (int u = 1; u < 5; ++u) EXPECT_EQ(depth(u, 0), 0) << name << " at " << u;
        EXPECT_FLOAT_EQ(depth(5, 0), 13.1f) << name;
    }
    const DepthImage millimetres = to_metres(read_raw_depth(folder / "d.tiff", kSize, 10.0f), kFloatDepthScale);
    EXPECT_NEAR(millimetres(0, 0), 0.12346f, 0.0001f) << "ten units are a metre";
    EXPECT_NE(message_of<Error>([&] { (void)read_color(folder / "z.exr", kSize); }).find("is a 32-bit float image"),
              std::string::npos);
}

TEST(FloatDepth, OfSeveralChannelsTheOneOfDepthIsTaken) {
    const TempFolder folder;
    const std::string file = (folder / "d.exr").string();
    const DepthImage one(kSize.width, kSize.height, 1.0f), two(kSize.width, kSize.height, 2.0f);
    Imf::Header header(kSize.width, kSize.height);
    Imf::FrameBuffer frame;
    for (const char* channel : {"A", "B", "G", "R", "Z"}) {
        header.channels().insert(channel, Imf::Channel(Imf::FLOAT));
        const DepthImage& values = *channel == 'Z' ? two : one;
        frame.insert(channel, Imf::Slice::Make(Imf::FLOAT, values.data(), header.dataWindow()));
    }
    {
        Imf::OutputFile out(file.c_str(), header);
        out.setFrameBuffer(frame);
        out.writePixels(kSize.height);
    }
    EXPECT_FLOAT_EQ(to_metres(read_raw_depth(file, kSize), kFloatDepthScale)(3, 3), 2.0f);
}

TEST(ImageFile, WrongTypesAreNamed) {
    const TempFolder folder;
    write_png(folder / "color.png", ramp());
    write_jpeg(folder / "color.jpg", ramp(), 90);
    write_depth(folder / "depth.png", DepthImage(kSize.width, kSize.height, 1), 5000);
    folder.write("text.png", "no image at all, only text that goes on for some time");
    const auto color = [&](const char* f) { return message_of<Error>([&] { (void)read_color(folder / f, kSize); }); };
    const auto depth = [&](const char* f) {
        return message_of<Error>([&] { (void)read_depth(folder / f, kSize, 5000); });
    };
    const auto labels = [&](const char* f) { return message_of<Error>([&] { (void)read_labels(folder / f, kSize); }); };
    EXPECT_NE(color("depth.png").find("depth.png: is a 16-bit image"), std::string::npos) << color("depth.png");
    EXPECT_NE(color("text.png").find("neither a PNG nor a JPEG"), std::string::npos);
    EXPECT_NE(color("none.png").find("missing"), std::string::npos);
    EXPECT_NE(depth("color.png").find("not a 16-bit grey image"), std::string::npos);
    EXPECT_NE(depth("color.jpg").find("not a 16-bit grey image"), std::string::npos);
    write_labels(folder / "grey.png", LabelImage(kSize.width, kSize.height, 90));
    EXPECT_NE(depth("grey.png").find("is an 8-bit image: 256 steps are a picture of depth, not a measurement; export"),
              std::string::npos)
        << depth("grey.png");
    EXPECT_NE(labels("depth.png").find("not an 8-bit grey PNG"), std::string::npos);
    EXPECT_NE(labels("color.png").find("not an 8-bit grey PNG"), std::string::npos);
    EXPECT_THROW((void)read_color(folder.path(), kSize), Error);
}

TEST(ImageFile, WrongSizesAreNamed) {
    const TempFolder folder;
    write_png(folder / "color.png", ramp());
    write_depth(folder / "depth.png", DepthImage(kSize.width, kSize.height, 1), 5000);
    EXPECT_NE(message_of<Error>([&] {
                  (void)read_color(folder / "color.png", {640, 480});
              }).find("24x16, expected 640x480"),
              std::string::npos);
    EXPECT_THROW((void)read_depth(folder / "depth.png", {16, 24}, 5000), Error);
    EXPECT_THROW((void)read_photo(folder / "color.png", 20), Error);
    EXPECT_EQ(read_photo(folder / "color.png").width(), 24);
}

TEST(ImageFile, EveryTruncationIsAnErrorAndNoneCrashes) {
    const TempFolder folder;
    write_png(folder / "color.png", ramp());
    write_jpeg(folder / "color.jpg", ramp(), 90);
    write_depth(folder / "depth.png", DepthImage(kSize.width, kSize.height, 1), 5000);
    for (const char* name : {"color.png", "color.jpg"}) {
        const std::string all = read_all(folder / name);
        for (std::size_t length = 0; length < all.size(); ++length) {
            const auto cut = folder.write("cut", all.substr(0, length));
            ASSERT_NE(message_of<Error>([&] { (void)read_color(cut, kSize); }), "") << name << " cut to " << length;
        }
    }
    const std::string all = read_all(folder / "depth.png");
    for (std::size_t length = 0; length < all.size(); ++length) {
        const auto cut = folder.write("cut", all.substr(0, length));
        ASSERT_NE(message_of<Error>([&] { (void)read_depth(cut, kSize, 5000); }), "") << "cut to " << length;
    }
}

/// Every format beside PNG and JPEG, cut anywhere and spoilt anywhere.
TEST(ImageFile, NoDamageToOtherFormatsDoesHarm) {
    const TempFolder folder;
    const cv::Mat color(kSize.height, kSize.width, CV_8UC3, cv::Scalar(50, 100, 200)),
        depth(kSize.height, kSize.width, CV_16UC1, cv::Scalar(1234)),
        metres(kSize.height, kSize.width, CV_32FC1, cv::Scalar(1.5));
    const std::vector<std::pair<std::string, cv::Mat>> images{{"c.tiff", color},  {"c.bmp", color},  {"c.ppm", color},
                                                              {"c.webp", color},  {"d.tiff", depth}, {"d.pgm", depth},
                                                              {"f.tiff", metres}, {"f.exr", metres}};
    for (const auto& [name, image] : images) {
        ASSERT_TRUE(cv::imwrite((folder / name).string(), image));
        const std::string all = read_all(folder / name);
        Rgb8 last_color;
        std::uint16_t last_depth = 0;
        const auto read = [&](const std::string& bytes) {
            const auto file = folder.write("damaged", bytes);
            return message_of<Error>([&] {
                if (name[0] == 'c')
                    last_color = read_color(file, kSize)(kSize.width - 1, kSize.height - 1);
                else
                    last_depth = read_raw_depth(file, kSize)(kSize.width - 1, kSize.height - 1);
            });
        };
        ASSERT_EQ(read(all), "") << name;
        const Rgb8 whole_color = last_color;
        const std::uint16_t whole_depth = last_depth;
        for (std::size_t length = 0; length < all.size(); length += 1 + all.size() / 200) {
            if (read(all.substr(0, length)) != "") continue;
            EXPECT_GE(length + 4, all.size()) << name << ": only what says that nothing follows may be missing";
            EXPECT_TRUE(last_color == whole_color && last_depth == whole_depth) << name << " cut to " << length;
        }
        for (std::size_t at = 0; at < all.size(); ++at) {
            std::string damaged = all;
            damaged[at] = static_cast<char>(damaged[at] ^ 0x5A);
            EXPECT_EQ(read(damaged).find('\n'), std::string::npos) << name << " at " << at;
        }
    }
    EXPECT_NE(message_of<Error>([&] {
                  (void)read_color(folder.write("text.pgm", "P2\n2 1 9\n1 2\n"), {2, 1});
              }).find("in text form (P2)"),
              std::string::npos);
}

TEST(ImageFile, DamagedBytesAreAnErrorOrAnImageAndNeverACrash) {
    const TempFolder folder;
    write_png(folder / "color.png", ramp());
    write_jpeg(folder / "color.jpg", ramp(), 90);
    for (const char* name : {"color.png", "color.jpg"}) {
        const std::string all = read_all(folder / name);
        for (std::size_t at = 0; at < all.size(); ++at) {
            std::string damaged = all;
            damaged[at] = static_cast<char>(damaged[at] ^ 0x5A);
            const auto file = folder.write("damaged", damaged);
            try {
                const ColorImage image = read_color(file, kSize);
                ASSERT_EQ(image.width(), kSize.width);
            } catch (const Error&) {
            }
        }
    }
}

TEST(ImageFile, AHugeSizeInTheHeaderIsRefusedBeforeMemoryIsTaken) {
    const TempFolder folder;
    write_png(folder / "a.png", ramp());
    std::string bomb = read_all(folder / "a.png");
    bomb.replace(16, 8, big_endian(0x7FFFFFFF) + big_endian(0x7FFFFFFF));
    const auto file = folder.write("bomb.png", bomb);
    EXPECT_NE(message_of<Error>([&] { (void)read_color(file, kSize); }).find("2147483647x2147483647"),
              std::string::npos);
    EXPECT_THROW((void)read_photo(file), Error);
}

TEST(ImageFile, UnwritablePlacesAreNamed) {
    const TempFolder folder;
    EXPECT_NE(message_of<Error>([&] { write_png(folder / "none/a.png", ramp()); }).find("none/a.png"),
              std::string::npos);
    EXPECT_THROW(write_png("/dev/full", ramp()), Error);
}

}  // namespace
}  // namespace posefusion
