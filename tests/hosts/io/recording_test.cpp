#include "hosts/io/recording.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "engine/core/error.hpp"
#include "hosts/io/image_file.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

using test::message_of;
using test::TempFolder;

constexpr int kWidth = 32, kHeight = 24;
const std::string kCamera = "fx: 30\nfy: 30\ncx: 15.5\ncy: 11.5\nwidth: 32\nheight: 24\ndepth_scale: 5000\n";

/// A recording of three frames; frame i is 1 + i metres away and has red = 50 + i.
class RecordingTest : public testing::Test {
protected:
    void SetUp() override {
        folder.write("camera.yaml", kCamera);
        folder.write("rgb.txt",
                     "# colour\n# timestamp filename\n10.000000 rgb/a.png\n10.033333 rgb/b.png\n10.066667 rgb/c.png\n");
        folder.write("depth.txt", "10.001 depth/a.png\n10.034 depth/b.png\n10.067 depth/c.png\n");
        std::filesystem::create_directories(folder / "rgb");
        std::filesystem::create_directories(folder / "depth");
        for (int i = 0; i < 3; ++i) {
            const std::string name = std::string(1, static_cast<char>('a' + i)) + ".png";
            write_png(folder / ("rgb/" + name),
                      ColorImage(kWidth, kHeight, {static_cast<std::uint8_t>(50 + i), 60, 70}));
            write_depth(folder / ("depth/" + name), DepthImage(kWidth, kHeight, static_cast<float>(1 + i)), 5000);
        }
    }
    std::string fault(const SourceOptions& options = {}) const {
        const std::string message = message_of<Error>([&] { Recording(folder.path(), options); });
        EXPECT_EQ(message.find('\n'), std::string::npos) << message;
        return message;
    }
    std::string load_fault(std::size_t i) const {
        const Recording recording(folder.path());
        return message_of<Error>([&] { (void)recording.load(i); });
    }
    TempFolder folder;
};

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST_F(RecordingTest, IsReadInOrder) {
    const Recording recording(folder.path());
    ASSERT_EQ(recording.size(), 3u);
    EXPECT_TRUE(recording.warnings().empty());
    EXPECT_FLOAT_EQ(recording.intrinsics().fx, 30);
    for (std::size_t i = 0; i < 3; ++i) {
        const Frame frame = recording.load(i);
        EXPECT_EQ(frame.index, i);
        EXPECT_NEAR(to_seconds(frame.stamp), 10 + static_cast<double>(i) / 30, 1e-6);
        EXPECT_EQ(frame.color(5, 5).r, 50 + i);
        EXPECT_FLOAT_EQ(frame.depth(5, 5), static_cast<float>(1 + i));
    }
    EXPECT_EQ(recording.load(1).stamp_text, "10.033333");
    EXPECT_FALSE(recording.groundtruth());
}

TEST_F(RecordingTest, IsShrunk) {
    SourceOptions options;
    options.scale = 0.5f;
    const Recording recording(folder.path(), options);
    EXPECT_EQ(recording.intrinsics().width, kWidth / 2);
    EXPECT_FLOAT_EQ(recording.intrinsics().cx, 7.5f);
    const Frame frame = recording.load(2);
    EXPECT_EQ(frame.color.width(), kWidth / 2);
    EXPECT_EQ(frame.depth.height(), kHeight / 2);
    EXPECT_FLOAT_EQ(frame.depth(3, 3), 3);
    EXPECT_EQ(frame.color(3, 3).r, 52);
}

TEST_F(RecordingTest, MayComeFromWindowsAndHaveOddLines) {
    folder.write(
        "rgb.txt",
        "\xEF\xBB\xBF# colour\r\n\r\n10.000000\trgb/a.png\r\nnan rgb/b.png\r\nhello\r\n10.033333 rgb/b.png\r\n");
    const Recording recording(folder.path());
    EXPECT_EQ(recording.size(), 2u);
    ASSERT_EQ(recording.warnings().size(), 1u);
    EXPECT_TRUE(has(recording.warnings()[0], "2 lines left out, the first is line 4")) << recording.warnings()[0];
    EXPECT_EQ(recording.load(1).color(0, 0).r, 51);
}

TEST_F(RecordingTest, PathsInListsMayHoldBlanksQuotesAndBackslashes) {
    std::filesystem::create_directories(folder / "my rgb,  2");
    std::filesystem::copy(folder / "rgb/b.png", folder / "my rgb,  2/b 3.png");
    folder.write("rgb.txt", "10.0 rgb\\a.png\n10.033333 my rgb,  2/b 3.png\n10.066667 \"rgb/c.png\"\n");
    const auto expect_three = [&] {
        const Recording recording(folder.path());
        EXPECT_TRUE(recording.warnings().empty());
        ASSERT_EQ(recording.size(), 3u);
        for (std::size_t i = 0; i < 3; ++i) {
            EXPECT_EQ(recording.load(i).color(0, 0).r, 50 + i);
            EXPECT_FLOAT_EQ(recording.load(i).depth(0, 0), 1 + static_cast<float>(i));
        }
    };
    expect_three();
    std::filesystem::remove(folder / "rgb.txt");
    const std::string pairs =
        "10.0 .\\rgb\\a.png 10.0 depth\\a.png\r\n10.033333 my rgb,  2\\b 3.png 10.033333 depth/b.png 0 0 0\r\n"
        "10.066667,\"rgb/c.png\",10.066667,\"depth/c.png\"\r\n";
    folder.write("associations.txt", pairs);
    expect_three();
    std::string wide = "\xFF\xFE";
    for (const char c : pairs) wide += {c, '\0'};
    folder.write("associations.txt", wide);
    expect_three();
    // a backslash in a name is left alone where such a file is there
    std::filesystem::copy(folder / "rgb/c.png", folder / "rgb\\a.png");
    folder.write("associations.txt", "10.0 rgb\\a.png 10.0 depth/a.png\n");
    EXPECT_EQ(Recording(folder.path()).load(0).color(0, 0).r, 52);
}

TEST_F(RecordingTest, FilesInListsMayHaveNamesWithoutAnEnding) {
    std::filesystem::rename(folder / "rgb/a.png", folder / "rgb/a");
    std::filesystem::rename(folder / "depth/a.png", folder / "depth/a");
    for (const char* line : {"10.0 rgb/a 10.0 depth/a\n", "10.0 rgb/a 10.0 depth/b.png\n"}) {
        folder.write("associations.txt", line);
        EXPECT_EQ(Recording(folder.path()).load(0).color(0, 0).r, 50) << line;
    }
}

TEST_F(RecordingTest, OrderAndRepetitionAreMended) {
    folder.write("rgb.txt", "10.066667 rgb/c.png\n10.0 rgb/a.png\n10.033333 rgb/b.png\n10.0 rgb/c.png\n");
    const Recording recording(folder.path());
    ASSERT_EQ(recording.size(), 3u);
    EXPECT_EQ(recording.warnings().size(), 2u);
    EXPECT_EQ(recording.load(0).color(0, 0).r, 50);
    EXPECT_EQ(recording.load(2).color(0, 0).r, 52);
}

TEST_F(RecordingTest, PausesAreTold) {
    folder.write("depth.txt", "10.001 depth/a.png\n10.034 depth/b.png\n3610.067 depth/c.png\n");
    folder.write("rgb.txt", "10.000 rgb/a.png\n10.033 rgb/b.png\n3610.066 rgb/c.png\n");
    const Recording paused(folder.path());
    ASSERT_EQ(paused.warnings().size(), 1u);
    EXPECT_TRUE(has(paused.warnings()[0], "nothing was recorded for 3600.0 s after frame 1")) << paused.warnings()[0];
    folder.write("depth.txt", "33.1 depth/a.png\n66.5 depth/b.png\n99.9 depth/c.png\n");
    folder.write("rgb.txt", "33.1 rgb/a.png\n66.5 rgb/b.png\n99.9 rgb/c.png\n");
    const Recording slow(folder.path());
    ASSERT_EQ(slow.warnings().size(), 1u);
    EXPECT_TRUE(has(slow.warnings()[0], "its frames are 33.4 s apart")) << slow.warnings()[0];
    SourceOptions options;
    options.time_unit = TimeUnit::Milliseconds;
    EXPECT_EQ(Recording(folder.path(), options).frames()[0].stamp, std::chrono::microseconds(33100));
}

/// Whole numbers of any unit give the frames and the times that seconds give.
TEST_F(RecordingTest, TimeStampsMayCountAnything) {
    const auto write = [&](const std::vector<std::string>& color, const std::vector<std::string>& depth) {
        std::string rgb_list, depth_list;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::string name(1, static_cast<char>('a' + i));
            rgb_list += color[i] + " rgb/" + name + ".png\n";
            depth_list += depth[i] + " depth/" + name + ".png\n";
        }
        folder.write("rgb.txt", rgb_list);
        folder.write("depth.txt", depth_list);
    };
    const auto expect = [&](const std::string& unit, Stamp first) {
        const Recording recording(folder.path());
        ASSERT_EQ(recording.size(), 3u) << unit;
        const std::vector<Stamp> stamps{recording.load(0).stamp, recording.load(1).stamp, recording.load(2).stamp};
        EXPECT_EQ(stamps[0], first) << unit;
        EXPECT_NEAR(to_seconds(stamps[1] - stamps[0]), 1 / 30.0, 1e-3) << unit;
        EXPECT_NEAR(to_seconds(stamps[2] - stamps[0]), 2 / 30.0, 1e-3) << unit;
        EXPECT_FLOAT_EQ(recording.load(2).depth(5, 5), 3);
        ASSERT_EQ(recording.warnings().size(), 2u) << unit;
        EXPECT_TRUE(has(recording.warnings()[0], "rgb.txt: time stamps are taken as " + unit))
            << recording.warnings()[0];
    };
    write({"1403636579763555584", "1403636579796888917", "1403636579830222250"},
          {"1403636579764555584", "1403636579797888917", "1403636579831222250"});
    expect("ns", Stamp{1403636579763555584});
    write({"1403636579763555", "1403636579796888", "1403636579830222"},
          {"1403636579764555", "1403636579797888", "1403636579831222"});
    expect("us", std::chrono::microseconds(1403636579763555));
    write({"1403636579763", "1403636579796", "1403636579830"}, {"1403636579764", "1403636579797", "1403636579831"});
    expect("ms", std::chrono::milliseconds(1403636579763));
    write({"0", "33333333", "66666666"}, {"1000000", "34333333", "67666666"});
    expect("ns", Stamp{});
    write({"5", "38", "72"}, {"6", "39", "73"});
    expect("ms", std::chrono::milliseconds(5));
    write({"5", "38", "72"}, {"0.006", "0.039", "0.073"});
    EXPECT_TRUE(has(fault(), "rgb.txt look like ms, those of depth.txt like s")) << fault();
}

TEST_F(RecordingTest, AListThatSaysNothingOfTheTimeIsRefused) {
    folder.write("rgb.txt", "0 rgb/a.png\n0 rgb/b.png\n0 rgb/c.png\n");
    EXPECT_TRUE(has(fault(), "most of its time stamps are alike")) << fault();
}

TEST_F(RecordingTest, PairsWithoutTimesAreThirtyASecond) {
    folder.write("associations.txt", "0 rgb/b.png 0 depth/b.png\n0 rgb/a.png 0 depth/a.png\n");
    const Recording recording(folder.path());
    ASSERT_EQ(recording.size(), 2u);
    EXPECT_EQ(recording.load(0).color(5, 5).r, 51);
    EXPECT_EQ(recording.load(1).stamp_text, "0.033333");
    ASSERT_EQ(recording.warnings().size(), 1u);
}

TEST_F(RecordingTest, ImagesWithoutPartnerAreLeftOut) {
    folder.write("depth.txt", "10.001 depth/a.png\n10.054 depth/b.png\n10.067 depth/c.png\n");
    const Recording recording(folder.path());
    EXPECT_EQ(recording.size(), 2u);
    ASSERT_EQ(recording.warnings().size(), 1u);
    EXPECT_TRUE(has(recording.warnings()[0], "1 colour image without a depth image"));
    folder.write("depth.txt", "99 depth/a.png\n");
    EXPECT_TRUE(has(fault(), "within 20 ms"));
}

TEST_F(RecordingTest, AssociationsCountWhereTheyAreThere) {
    folder.write("associations.txt", "10.0 rgb/a.png 10.3 depth/b.png\n");
    const Recording recording(folder.path());
    ASSERT_EQ(recording.size(), 1u);
    EXPECT_FLOAT_EQ(recording.load(0).depth(0, 0), 2);
    std::filesystem::remove(folder / "rgb.txt");
    EXPECT_EQ(Recording(folder.path()).size(), 1u);
}

TEST_F(RecordingTest, AssociationsMayListDepthFirst) {
    folder.write("associations.txt", "7.5 depth/b.png 10.0 rgb/a.png\n");
    const Frame frame = Recording(folder.path()).load(0);
    EXPECT_EQ(frame.stamp, std::chrono::seconds(10));
    EXPECT_FLOAT_EQ(frame.depth(0, 0), 2);
}

TEST_F(RecordingTest, FaultyListsAreNamed) {
    folder.write("rgb.txt", "");
    EXPECT_TRUE(has(fault(), "rgb.txt: is empty")) << fault();
    folder.write("rgb.txt", "these are\nno stamps\n");
    EXPECT_TRUE(has(fault(), "rgb.txt: no line can be used")) << fault();
    std::filesystem::remove(folder / "rgb.txt");
    EXPECT_TRUE(has(fault(), "no recording in TUM layout")) << fault();
    folder.write("associations.txt", "1 2 3\n");
    EXPECT_TRUE(has(fault(), "associations.txt: no line can be used")) << fault();
    EXPECT_TRUE(has(message_of<Error>([&] { Recording(folder / "nowhere"); }), "not found"));
    EXPECT_TRUE(has(message_of<Error>([&] { Recording(folder / "camera.yaml"); }), "is not a folder"));
}

TEST_F(RecordingTest, TheCameraIsAskedForInOneLine) {
    std::filesystem::remove(folder / "camera.yaml");
    EXPECT_TRUE(has(fault(), "--camera FILE")) << fault();
    SourceOptions options;
    options.camera_file = folder.write("elsewhere.yaml", kCamera);
    EXPECT_FLOAT_EQ(Recording(folder.path(), options).intrinsics().fx, 30);
    options.camera_file = folder / "none.yaml";
    EXPECT_TRUE(has(fault(options), "none.yaml: camera file not found"));
    folder.write("camera.yaml", "fx: -1\n");
    EXPECT_TRUE(has(fault(), "camera.yaml: 'fx' must be positive"));
}

TEST_F(RecordingTest, TheCameraOfATumFolderIsKnown) {
    std::filesystem::remove(folder / "camera.yaml");
    std::filesystem::copy(folder.path(), folder / "rgbd_dataset_freiburg3_test");
    EXPECT_FLOAT_EQ(Recording(folder / "rgbd_dataset_freiburg3_test").intrinsics().fx, 535.4f);
    EXPECT_FLOAT_EQ(Recording(folder.path().string() + "/rgbd_dataset_freiburg3_test/").intrinsics().fx, 535.4f);
    EXPECT_EQ(Recording(folder.path().string() + "/rgbd_dataset_freiburg3_test/").name(),
              "rgbd_dataset_freiburg3_test");
}

TEST_F(RecordingTest, FaultyImagesAreNamed) {
    write_png(folder / "rgb/a.png", ColorImage(kWidth, kHeight + 1, {9, 9, 9}));
    EXPECT_TRUE(has(load_fault(0), "rgb/a.png: image is 32x25, expected 32x24"));
    write_png(folder / "rgb/a.png", ColorImage(kWidth, kHeight));
    EXPECT_TRUE(has(load_fault(0), "rgb/a.png: colour image is black"));
    std::filesystem::remove(folder / "rgb/a.png");
    EXPECT_TRUE(has(load_fault(0), "rgb/a.png: image file is missing"));
    write_depth(folder / "depth/b.png", DepthImage(kWidth, kHeight), 5000);
    EXPECT_TRUE(has(load_fault(1), "depth/b.png: depth image holds no measurement"));
    folder.write("depth/b.png", "");
    EXPECT_TRUE(has(load_fault(1), "depth/b.png: image file is empty"));
    std::filesystem::copy_file(folder / "rgb/b.png", folder / "depth/b.png",
                               std::filesystem::copy_options::overwrite_existing);
    EXPECT_TRUE(has(load_fault(1), "depth/b.png: is not a 16-bit grey image"));
    EXPECT_EQ(load_fault(2), "");
}

TEST_F(RecordingTest, GroundTruthIsRead) {
    folder.write("groundtruth.txt", "# truth\n10.0 1 2 3 0 0 0 1\n");
    EXPECT_DOUBLE_EQ(Recording(folder.path()).groundtruth()->at(0).T_world_camera.translation().z(), 3);
    folder.write("groundtruth.txt", "rubbish\n");
    EXPECT_THROW((void)Recording(folder.path()).groundtruth(), Error);
}

TEST(BadFrames, OneIsSkippedWithAWarning) {
    BadFrames frames(100);
    for (int i = 0; i < 30; ++i) {
        frames.good();
        EXPECT_EQ(frames.bad("x.png: torn"), "frame skipped: x.png: torn");
    }
    EXPECT_EQ(frames.skipped(), 30u);
}

TEST(BadFrames, ManyInARowAreShownInPart) {
    BadFrames frames(FrameSource::kEndless);  // a camera in the dark
    std::vector<std::string> shown;
    for (int i = 0; i < 250; ++i)
        if (const std::string text = frames.bad("dark"); !text.empty()) shown.push_back(text);
    ASSERT_EQ(shown.size(), 7u);
    EXPECT_EQ(shown[3], "frame skipped: dark");
    EXPECT_TRUE(has(shown[4], "every 100th is shown")) << shown[4];
    EXPECT_EQ(shown[6], "200 frames in a row skipped, the last: dark");
    frames.good();
    EXPECT_EQ(frames.bad("dark"), "frame skipped: dark");
    EXPECT_EQ(frames.skipped(), 251u);
}

TEST(BadFrames, NothingElseEndsTheRun) {
    BadFrames few(3);
    EXPECT_NO_THROW(few.bad("a"));
    EXPECT_NO_THROW(few.bad("b"));
    EXPECT_TRUE(has(message_of<Error>([&] { few.bad("c.png: torn"); }),
                    "no frame of the recording can be used; the last fault: c.png: torn"));
    BadFrames dark_at_first(1000);
    for (int i = 0; i < 999; ++i) EXPECT_NO_THROW(dark_at_first.bad("a")) << "the last one may be usable";
}

TEST(CheckUsable, DepthMustLieInTheRange) {
    Frame frame;
    frame.color = ColorImage(4, 4, {90, 90, 90});
    frame.depth = DepthImage(4, 4, 7.0f);
    EXPECT_NO_THROW(check_usable(frame, {}, "c.png", "d.png"));
    EXPECT_EQ(
        message_of<Error>([&] {
            check_usable(frame, {0.3f, 5}, "c.png", "d.png");
        }),
        "d.png: no depth between 0.3 and 5 m (preprocess.depth_min, depth_max), the median is 7.00 m; is depth_scale "
        "in the camera file right?");
    frame.depth(3, 3) = 5;
    EXPECT_NO_THROW(check_usable(frame, {0.3f, 5}, "c.png", "d.png"));
    frame.depth = DepthImage(4, 4, 0.0f);
    EXPECT_EQ(message_of<Error>([&] {
                  check_usable(frame, {0.3f, 5}, "c.png", "d.png");
              }),
              "d.png: depth image holds no measurement");
    frame.color = ColorImage(4, 4, {3, 8, 5});
    EXPECT_TRUE(
        has(message_of<Error>([&] { check_usable(frame, {}, "c.png", "d.png"); }), "c.png: colour image is black"));
}

/// The shared recordings, read through and through.
class SharedRecording : public testing::TestWithParam<const char*> {};

TEST_P(SharedRecording, IsReadWithoutComplaint) {
    const auto folder = test::shared_data() / GetParam();
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << "needs the shared recordings at " << folder;
    const Recording recording(folder);
    EXPECT_TRUE(recording.warnings().empty()) << recording.warnings().front();
    EXPECT_GE(recording.size(), 50u);
    EXPECT_TRUE(recording.groundtruth());
    for (const std::size_t i : {std::size_t{0}, recording.size() / 2, recording.size() - 1}) {
        const Frame frame = recording.load(i);
        EXPECT_EQ(frame.color.width(), 640);
        const auto measured =
            std::count_if(frame.depth.begin(), frame.depth.end(), [](float d) { return d > 0.2f && d < 14; });
        EXPECT_GT(measured, 100000);
    }
}
INSTANTIATE_TEST_SUITE_P(All, SharedRecording,
                         testing::Values("house/walk_xyz", "house/static_xyz", "real/tum_fr1_rpy", "real/redkitchen",
                                         "real/person_turning"));

}  // namespace
}  // namespace posefusion
