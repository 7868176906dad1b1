#include "hosts/io/sources/openni_source.hpp"

#include "tests/hosts/io/sources/frames.hpp"

namespace posefusion::test {
namespace {

#if POSEFUSION_OPENNI

class OpenNi : public testing::Test {
protected:
    TempFolder folder;
};

TEST_F(OpenNi, WithoutACameraSaysSoInOneLine) {
    EXPECT_TRUE(has(open_fault("openni2:"), "openni2:: no such camera")) << open_fault("openni2:");
    EXPECT_TRUE(has(open_fault("openni2:no/such@camera"), "no such camera"));
}

/// Debian's OpenNI2 brings a driver for a camera that is not there, for tests: 320x240, all zeros.
TEST_F(OpenNi, ACameraGivesFrameAfterFrame) {
    EXPECT_TRUE(has(open_fault("openni2:Dummy"), "does not tell its camera")) << open_fault("openni2:Dummy");
    SourceOptions options;
    options.camera_file =
        folder.write("c.yaml", "fx: 300\nfy: 300\ncx: 160\ncy: 120\nwidth: 320\nheight: 240\n");
    const auto source = open_source("openni2:Dummy", options);
    EXPECT_FALSE(source->seekable());
    EXPECT_EQ(source->size(), FrameSource::kEndless);
    EXPECT_EQ(source->camera().depth_scale, 1000) << "OpenNI2 counts millimetres";
    double last = -1;
    for (std::size_t i = 0; i < 3; ++i) {
        const RawFrame frame = source->read(i);
        EXPECT_GT(frame.stamp, last);
        last = frame.stamp;
        EXPECT_EQ(frame.color.width(), 320);
        EXPECT_EQ(frame.depth.height(), 240);
    }
    options.camera_file = folder.write("d.yaml", "fx: 300\nfy: 300\ncx: 160\ncy: 120\nwidth: 640\nheight: 480\n");
    EXPECT_TRUE(has(message_of<Error>([&] { (void)open_source("openni2:Dummy", options)->read(0); }), "is not of the size"));
}

TEST_F(OpenNi, BadFilesAreRefusedBeforeOpenNiSeesThem) {
    EXPECT_TRUE(has(open_fault(folder.write("a.oni", "")), "too short"));
    EXPECT_TRUE(has(open_fault(folder.write("a.oni", std::string(100, 'x'))), "is no .oni file"));
    const std::string head = "NI10" + std::string(20, '\0');
    EXPECT_TRUE(has(open_fault(folder.write("a.oni", head)), "ends early"));
    EXPECT_TRUE(has(open_fault(folder.write("a.oni", head + std::string(28, '\xFF'))), "is damaged"));
    const auto record = [](char type, const std::string& payload_bytes) {
        return std::string("NIR\0", 4) + std::string{type, 0, 0, 0, 1, 0, 0, 0, 28, 0, 0, 0} + payload_bytes +
               std::string(8, '\0');
    };
    const std::string none(4, '\0'), absurd("\xFF\xFF\xFF\x7F"), much("\x00\x00\x01\x00", 4);
    EXPECT_TRUE(has(open_fault(folder.write("a.oni", head + record(10, absurd))), "is damaged"));
    EXPECT_TRUE(has(open_fault(folder.write("a.oni", head + record(10, much))), "ends early"));
    EXPECT_TRUE(has(open_fault(folder.write("a.oni", head + record(11, none))), "holds no images"));
}

#else

TEST(OpenNi, IsSaidToBeAbsent) {
    EXPECT_TRUE(has(open_fault("openni2:"), "built without OpenNI2"));
}

#endif

}  // namespace
}  // namespace posefusion::test
