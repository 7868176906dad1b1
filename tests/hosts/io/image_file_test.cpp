#include "hosts/io/image_file.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <opencv2/imgcodecs.hpp>

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
    EXPECT_NE(depth("color.png").find("not a 16-bit grey PNG"), std::string::npos);
    EXPECT_NE(depth("color.jpg").find("not a 16-bit grey PNG"), std::string::npos);
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
