#include <zlib.h>

#include <limits>

#include "hosts/io/recording.hpp"
#include "hosts/io/sources/klg_source.hpp"
#include "tests/hosts/io/sources/frames.hpp"

namespace posefusion::test {
namespace {

template <class Number>
std::string bytes_of(Number value) {
    return {reinterpret_cast<const char*>(&value), sizeof value};
}

std::string frame_header(std::int64_t stamp, std::int32_t depth, std::int32_t color) {
    return bytes_of(stamp) + bytes_of(depth) + bytes_of(color);
}

class Klg : public testing::Test {
protected:
    /// A log with this content, its camera beside it.
    std::filesystem::path log(const std::string& content) const {
        write_camera_file(folder / "log.yaml", test_camera());
        return folder.write("log.klg", content);
    }
    std::string read_fault(const std::filesystem::path& file, std::size_t i = 0) const {
        return message_of<Error>([&] { (void)open_source(file)->read(i); });
    }
    TempFolder folder;
};

class KlgRoundTrip : public testing::TestWithParam<bool> {};

TEST_P(KlgRoundTrip, KeepsImagesStampsAndCamera) {
    const TempFolder folder;
    RecordOptions options;
    options.compress = GetParam();
    const auto source = open_source(make_recording(folder / "log.klg", 4, options));
    ASSERT_EQ(source->size(), 4u) << "the last frame is read, too";
    EXPECT_TRUE(source->facts().warnings.empty());
    EXPECT_EQ(source->camera().intrinsics.fx, test_camera().intrinsics.fx);
    EXPECT_EQ(source->camera().depth_scale, 1000);
    for (const int i : {3, 0, 2, 1}) {
        expect_same(source->read(static_cast<std::size_t>(i)), make_frame(i));
        EXPECT_EQ(source->facts().frames[static_cast<std::size_t>(i)].stamp_text, make_frame(i).stamp_text);
    }
}
INSTANTIATE_TEST_SUITE_P(RawAndZlib, KlgRoundTrip, testing::Bool());

TEST_F(Klg, ZlibIsSmaller) {
    RecordOptions raw;
    raw.compress = false;
    EXPECT_LT(std::filesystem::file_size(make_recording(folder / "small.klg")),
              std::filesystem::file_size(make_recording(folder / "large.klg", 3, raw)));
}

TEST_F(Klg, JpegIsNearTheColours) {
    RecordOptions options;
    options.jpeg_quality = 95;
    const auto file = folder / "log.klg";
    const auto recorder = make_recorder(file, test_camera(), options);
    RawFrame frame = make_frame(0);
    for (Rgb8& c : frame.color) c = {200, 100, 50};
    recorder->add(frame);
    recorder->finish(std::nullopt);
    const RawFrame read = open_source(file)->read(0);
    EXPECT_NEAR(read.color(3, 3).r, 200, 3);
    EXPECT_NEAR(read.color(3, 3).b, 50, 3);
    SourceOptions flipped;
    flipped.flip_colors = true;
    EXPECT_NEAR(open_source(file, flipped)->read(0).color(3, 3).r, 50, 3);
}

/// Byte for byte as the format says, without our writer.
TEST_F(Klg, IsReadAsElasticFusionWritesIt) {
    const RawFrame frame = make_frame(0);
    const std::string raw(reinterpret_cast<const char*>(frame.depth.data()), frame.depth.size() * 2);
    std::string packed(compressBound(raw.size()), '\0');
    auto size = static_cast<uLongf>(packed.size());
    ASSERT_EQ(compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(raw.data()),
                       raw.size()),
              Z_OK);
    packed.resize(size);
    const std::string jpeg = encode_jpeg(frame.color, 100);
    const std::string colour(reinterpret_cast<const char*>(frame.color.data()), frame.color.size() * 3);
    const auto colour_bytes = static_cast<std::int32_t>(colour.size());
    const auto file =
        log(bytes_of(std::int32_t{2}) +
            frame_header(1500000, static_cast<std::int32_t>(packed.size()), static_cast<std::int32_t>(jpeg.size())) +
            packed + jpeg + frame_header(2500001, static_cast<std::int32_t>(raw.size()), colour_bytes) + raw + colour);
    const auto source = open_source(file);
    ASSERT_EQ(source->size(), 2u);
    const RawFrame first = source->read(0), second = source->read(1);
    EXPECT_EQ(first.stamp_text, "1.500000");
    EXPECT_EQ(second.stamp, std::chrono::microseconds(2500001));
    EXPECT_TRUE(std::equal(first.depth.begin(), first.depth.end(), frame.depth.begin()));
    EXPECT_TRUE(std::equal(second.depth.begin(), second.depth.end(), frame.depth.begin()));
    EXPECT_NEAR(first.color(9, 9).r, frame.color(9, 9).r, 20);
    EXPECT_EQ(source->facts().warnings.size(), 0u);
}

TEST_F(Klg, WithoutColourIsGreyAndSaysSo) {
    const RawFrame frame = make_frame(0);
    const std::string raw(reinterpret_cast<const char*>(frame.depth.data()), frame.depth.size() * 2);
    const auto depth_bytes = static_cast<std::int32_t>(raw.size());
    const std::string alone = frame_header(1500000, depth_bytes, 0) + raw + frame_header(1533333, depth_bytes, 0) + raw;
    const auto source = open_source(log(bytes_of(std::int32_t{2}) + alone));
    ASSERT_EQ(source->size(), 2u);
    ASSERT_EQ(source->facts().warnings.size(), 1u);
    EXPECT_TRUE(has(source->facts().warnings[0], "holds no colour; the camera is tracked on depth alone"));
    const Frame usable = Recording(log(bytes_of(std::int32_t{2}) + alone)).load(1);
    EXPECT_EQ(usable.color(9, 9), (Rgb8{128, 128, 128}));
    EXPECT_FLOAT_EQ(usable.depth(9, 9), 0.001f * frame.depth(9, 9));

    const std::string jpeg = encode_jpeg(frame.color, 100);
    const auto jpeg_bytes = static_cast<std::int32_t>(jpeg.size());
    const auto mixed = open_source(
        log(bytes_of(std::int32_t{3}) + alone + frame_header(1566667, depth_bytes, jpeg_bytes) + raw + jpeg));
    EXPECT_TRUE(mixed->facts().warnings.empty());
    EXPECT_TRUE(has(message_of<Error>([&] { (void)mixed->read(1); }), "frame 2, colour: is missing"));
    EXPECT_NEAR(mixed->read(2).color(9, 9).r, frame.color(9, 9).r, 20);
}

TEST_F(Klg, WithoutACameraElasticFusionsDefaultIsAssumedAloud) {
    const auto file = make_recording(folder / "log.klg");
    std::filesystem::remove(klg_camera_file(file));
    const auto source = open_source(file);
    EXPECT_EQ(source->camera().intrinsics.fx, 528);
    ASSERT_EQ(source->facts().warnings.size(), 1u);
    EXPECT_TRUE(has(source->facts().warnings[0], "--camera FILE"));
    EXPECT_TRUE(has(read_fault(file), "640x480")) << read_fault(file);
    SourceOptions options;
    options.camera_file = folder.write("c.yaml", "fx: 30\nfy: 30\ncx: 15\ncy: 11\nwidth: 32\nheight: 24\n");
    EXPECT_EQ(open_source(file, options)->camera().depth_scale, 1000) << "a log counts millimetres";
}

TEST_F(Klg, ItsGroundTruthLiesBesideIt) {
    const auto file = make_recording(folder / "log.klg");
    EXPECT_FALSE(open_source(file)->groundtruth());
    folder.write("log.groundtruth.txt", "1 1 2 3 0 0 0 1\n");
    EXPECT_EQ(open_source(file)->groundtruth()->size(), 1u);
}

TEST_F(Klg, ATruncatedLogGivesTheFramesThatAreWhole) {
    const auto file = make_recording(folder / "log.klg");
    const std::string content = read_all(file);
    write_bytes(file, content.substr(0, content.size() - 1));
    const auto source = open_source(file);
    EXPECT_EQ(source->size(), 2u);
    ASSERT_EQ(source->facts().warnings.size(), 1u);
    EXPECT_TRUE(has(source->facts().warnings[0], "3 frames announced, 2 can be used")) << source->facts().warnings[0];
    expect_same(source->read(1), make_frame(1));
}

/// The logger writes the number of frames last. Killed, it has not.
TEST_F(Klg, AllFramesAreUsedWhateverNumberIsAnnounced) {
    const auto file = make_recording(folder / "log.klg", 12);
    const std::string content = read_all(file);
    for (const auto& [announced, told] :
         {std::pair{5, "5 frames announced, 12 found and used"}, std::pair{0, "no frames announced"},
          std::pair{-1, "no frames announced"}, std::pair{20, "20 frames announced, 12 can be used: the file ends"}}) {
        write_bytes(file, bytes_of(std::int32_t{announced}) + content.substr(4));
        const auto source = open_source(file);
        ASSERT_EQ(source->size(), 12u) << announced;
        expect_same(source->read(11), make_frame(11));
        ASSERT_EQ(source->facts().warnings.size(), 1u) << announced;
        EXPECT_TRUE(has(source->facts().warnings[0], told)) << source->facts().warnings[0];
    }
}

TEST_F(Klg, WhatComesAfterTheLastFrameIsTold) {
    const auto file = make_recording(folder / "log.klg");
    write_bytes(file, read_all(file) + "something else");
    const auto source = open_source(file);
    EXPECT_EQ(source->size(), 3u);
    ASSERT_EQ(source->facts().warnings.size(), 1u);
    EXPECT_TRUE(has(source->facts().warnings[0], "after its 3 frames comes something that is left out: it ends early"))
        << source->facts().warnings[0];
}

TEST_F(Klg, WithoutAClockThirtyFramesASecondAreAssumed) {
    const auto recorder = make_recorder(folder / "log.klg", test_camera());
    for (int i = 0; i < 4; ++i) {
        RawFrame frame = make_frame(i);
        frame.stamp = Stamp{};
        recorder->add(frame);
    }
    recorder->finish(std::nullopt);
    const auto source = open_source(folder / "log.klg");
    ASSERT_EQ(source->size(), 4u);
    EXPECT_EQ(source->read(3).stamp_text, "0.100000");
    EXPECT_EQ(source->read(3).color(9, 9), make_frame(3).color(9, 9));
    ASSERT_EQ(source->facts().warnings.size(), 1u);
    EXPECT_TRUE(has(source->facts().warnings[0], "30 frames a second are assumed"));
}

TEST_F(Klg, FramesOfOneTimeAreCountedAndTold) {
    const auto recorder = make_recorder(folder / "log.klg", test_camera());
    for (const int i : {0, 1, 1, 2}) recorder->add(make_frame(i));
    recorder->finish(std::nullopt);
    const auto source = open_source(folder / "log.klg");
    EXPECT_EQ(source->size(), 3u);
    ASSERT_EQ(source->facts().warnings.size(), 1u);
    EXPECT_TRUE(has(source->facts().warnings[0], "1 frame with a time stamp that was there before left out"));
}

TEST_F(Klg, OrderIsMended) {
    const auto recorder = make_recorder(folder / "log.klg", test_camera());
    for (const int i : {2, 0, 1}) recorder->add(make_frame(i));
    recorder->finish(std::nullopt);
    const auto source = open_source(folder / "log.klg");
    expect_same(source->read(0), make_frame(0));
    ASSERT_EQ(source->facts().warnings.size(), 1u);
    EXPECT_TRUE(has(source->facts().warnings[0], "not in order"));
}

TEST_F(Klg, BadFilesAreNamed) {
    EXPECT_TRUE(has(open_fault(log("")), "too short"));
    EXPECT_TRUE(has(open_fault(log(std::string(100, '\0'))), "is damaged"));
    EXPECT_TRUE(has(open_fault(log(std::string(100, '\xFF'))), "is damaged"));
    EXPECT_TRUE(has(open_fault(log("this is a text and not a log at all, but long enough")), "is no .klg log"));
    const std::string many = bytes_of(std::numeric_limits<std::int32_t>::max());
    EXPECT_TRUE(has(open_fault(log(many + frame_header(1, 10, 10))), "ends early")) << "huge count";
    const std::int32_t huge = std::numeric_limits<std::int32_t>::max();
    EXPECT_TRUE(has(open_fault(log(many + frame_header(1, huge, 10))), "damaged")) << "absurd size";
    EXPECT_TRUE(has(open_fault(log(many + frame_header(1, 10, huge))), "damaged"));
    EXPECT_TRUE(has(open_fault(log(many + frame_header(1, -5, 10))), "damaged"));
    EXPECT_TRUE(has(open_fault(folder / "none.klg"), "not found"));
    std::filesystem::create_directories(folder / "folder.klg");
    EXPECT_NE(open_fault(folder / "folder.klg"), "");
}

/// 64 MiB of zeros in 64 KiB: only as much is unpacked as a depth image has.
TEST_F(Klg, AZipBombIsNotUnpacked) {
    const std::string zeros(std::size_t{1} << 26, '\0');
    std::string packed(compressBound(zeros.size()), '\0');
    auto size = static_cast<uLongf>(packed.size());
    ASSERT_EQ(compress2(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(zeros.data()),
                        zeros.size(), Z_BEST_COMPRESSION),
              Z_OK);
    packed.resize(size);
    const auto file =
        log(bytes_of(std::int32_t{1}) + frame_header(1, static_cast<std::int32_t>(packed.size()), 0) + packed);
    EXPECT_TRUE(has(read_fault(file), "is not of 32x24 pixels")) << read_fault(file);
}

TEST_F(Klg, SpoiltImagesAreNamed) {
    const std::string garbage(40, 'x');
    const auto file = log(bytes_of(std::int32_t{1}) + frame_header(1, 40, 0) + garbage);
    EXPECT_TRUE(has(read_fault(file), "log.klg, frame 1, depth: is neither zlib nor raw of")) << read_fault(file);
    const std::string raw(kWidth * kHeight * 2, '\1');
    const auto color =
        log(bytes_of(std::int32_t{1}) + frame_header(1, static_cast<std::int32_t>(raw.size()), 40) + raw + garbage);
    EXPECT_TRUE(has(read_fault(color), "frame 1, colour: is neither a PNG nor a JPEG")) << read_fault(color);
    const std::string jpeg = encode_jpeg(ColorImage(64, 48), 90);
    const auto large = log(
        bytes_of(std::int32_t{1}) +
        frame_header(1, static_cast<std::int32_t>(raw.size()), static_cast<std::int32_t>(jpeg.size())) + raw + jpeg);
    EXPECT_TRUE(has(read_fault(large), "64x48, expected 32x24")) << read_fault(large);
}

TEST_F(Klg, NoDamageDoesHarm) {
    RecordOptions options;
    options.jpeg_quality = 80;
    expect_no_harm_in_damage(make_recording(folder / "log.klg", 2, options), 7);
}

TEST_F(Klg, AHalfWrittenLogIsNotThere) {
    {
        const auto recorder = make_recorder(folder / "log.klg", test_camera());
        recorder->add(make_frame(0));
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
    EXPECT_NE(message_of<Error>([&] { (void)make_recorder("/proc/log.klg", test_camera()); }), "");
}

}  // namespace
}  // namespace posefusion::test
