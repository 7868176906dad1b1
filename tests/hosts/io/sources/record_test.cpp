#include "hosts/io/recorders/recorder.hpp"
#include "hosts/io/recording.hpp"
#include "tests/hosts/io/sources/bag_writer.hpp"
#include "tests/hosts/io/sources/frames.hpp"

namespace posefusion::test {
namespace {

class Record : public testing::Test {
protected:
    Recorded copy(const std::filesystem::path& from, const std::filesystem::path& to,
                  const RecordOptions& options = {}) {
        warnings.clear();
        RecordObserver observer;
        observer.progress = [](std::size_t) {};
        observer.warning = [&](const std::string& text) { warnings.push_back(text); };
        return record(*open_source(from), to, options, observer);
    }
    static void expect_same_recording(const std::filesystem::path& a, const std::filesystem::path& b) {
        const auto one = open_source(a), two = open_source(b);
        ASSERT_EQ(one->size(), two->size());
        for (std::size_t i = 0; i < one->size(); ++i) expect_same(one->read(i), two->read(i));
        EXPECT_EQ(one->camera().intrinsics.fx, two->camera().intrinsics.fx);
        EXPECT_EQ(one->camera().depth_scale, two->camera().depth_scale);
        EXPECT_EQ(one->camera().distortion, two->camera().distortion);
    }
    TempFolder folder;
    std::vector<std::string> warnings;
};

TEST_F(Record, TumToLogToTumKeepsEveryBit) {
    const auto tum = make_recording(folder / "tum", 4);
    folder.write("tum/groundtruth.txt", "1305031102.175304 1 2 3 0 0 0 1\n");
    EXPECT_EQ(copy(tum, folder / "log.klg").frames, 4u);
    EXPECT_EQ(copy(folder / "log.klg", folder / "again").frames, 4u);
    expect_same_recording(tum, folder / "log.klg");
    expect_same_recording(tum, folder / "again");
    for (const char* file : {"rgb.txt", "depth.txt", "associations.txt", "camera.yaml"})
        EXPECT_EQ(read_all(tum / file), read_all(folder / "again" / file)) << file;
    for (int i = 0; i < 4; ++i)
        for (const char* part : {"rgb/", "depth/"}) {
            const std::string name = part + make_frame(i).stamp_text + ".png";
            EXPECT_FALSE(read_all(tum / name).empty());
            EXPECT_EQ(read_all(tum / name), read_all(folder / "again" / name)) << name;
        }
    EXPECT_EQ(open_source(folder / "again")->groundtruth()->at(0).T_world_camera.translation().y(), 2);
    EXPECT_TRUE(warnings.empty());
}

TEST_F(Record, ALogWrittenTwiceHasTheSameBytes) {
    const auto first = make_recording(folder / "first.klg");
    copy(first, folder / "second.klg");
    EXPECT_EQ(read_all(first), read_all(folder / "second.klg"));
}

TEST_F(Record, ABagBecomesAFolder) {
    const std::filesystem::path bag = std::filesystem::path(POSEFUSION_TEST_DATA) / "lz4.bag";
    copy(bag, folder / "tum");
    expect_same_recording(bag, folder / "tum");
    copy(folder / "tum", folder / "log.klg");
    expect_same_recording(bag, folder / "log.klg");
}

/// What the pipeline gets is the same, bit for bit, whatever the format.
TEST_F(Record, ThePipelineSeesTheSameFrames) {
    const auto tum = make_recording(folder / "tum", 3);
    copy(tum, folder / "log.klg");
    for (const float scale : {1.0f, 0.5f}) {
        SourceOptions options;
        options.scale = scale;
        const Recording a(tum, options), b(folder / "log.klg", options);
        EXPECT_EQ(a.intrinsics().cx, b.intrinsics().cx);
        for (std::size_t i = 0; i < a.size(); ++i) {
            const Frame x = a.load(i), y = b.load(i);
            EXPECT_EQ(x.stamp, y.stamp);
            EXPECT_TRUE(std::equal(x.color.begin(), x.color.end(), y.color.begin(), y.color.end()));
            EXPECT_TRUE(std::equal(x.depth.begin(), x.depth.end(), y.depth.begin(), y.depth.end()));
        }
    }
}

TEST_F(Record, StopsWhenTold) {
    const auto tum = make_recording(folder / "tum", 4);
    RecordOptions options;
    options.max_frames = 2;
    EXPECT_EQ(copy(tum, folder / "short.klg", options).frames, 2u);
    EXPECT_EQ(open_source(folder / "short.klg")->size(), 2u);
}

TEST_F(Record, BadFramesAreSkipped) {
    const auto tum = make_recording(folder / "tum", 3);
    folder.write("tum/rgb/" + make_frame(1).stamp_text + ".png", "damaged");
    const Recorded result = copy(tum, folder / "log.klg");
    EXPECT_EQ(result.frames, 2u);
    EXPECT_EQ(result.skipped, 1u);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_TRUE(has(warnings[0], "frame skipped"));
    expect_same(open_source(folder / "log.klg")->read(1), make_frame(2));
    for (int i = 0; i < 3; ++i) folder.write("tum/rgb/" + make_frame(i).stamp_text + ".png", "damaged");
    EXPECT_TRUE(has(message_of<Error>([&] { copy(tum, folder / "none.klg"); }), "no frame of the recording"));
    EXPECT_FALSE(std::filesystem::exists(folder / "none.klg"));
}

TEST_F(Record, DoesNotWriteIntoARecording) {
    const auto tum = make_recording(folder / "tum");
    EXPECT_TRUE(has(message_of<Error>([&] { copy(tum, tum); }), "holds a recording already"));
    expect_same(open_source(tum)->read(2), make_frame(2));
}

}  // namespace
}  // namespace posefusion::test
