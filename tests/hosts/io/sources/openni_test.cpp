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
    EXPECT_TRUE(has(open_fault("openni2:"), "openni2: no such camera")) << open_fault("openni2:");
    EXPECT_TRUE(has(open_fault("openni2:no/such@camera"), "no such camera"));
}

/// Debian's OpenNI2 brings a driver for a camera that is not there, for tests: 320x240, all zeros.
TEST_F(OpenNi, ACameraGivesFrameAfterFrame) {
    EXPECT_TRUE(has(open_fault("openni2:Dummy"), "does not say what its camera is")) << open_fault("openni2:Dummy");
    SourceOptions options;
    options.camera_file = folder.write("c.yaml", "fx: 300\nfy: 300\ncx: 160\ncy: 120\nwidth: 320\nheight: 240\n");
    const auto source = open_source("openni2:Dummy", options);
    EXPECT_FALSE(source->seekable());
    EXPECT_EQ(source->size(), FrameSource::kEndless);
    EXPECT_EQ(source->camera().depth_scale, 1000) << "OpenNI2 counts millimetres";
    Stamp last{-1};
    for (std::size_t i = 0; i < 3; ++i) {
        const RawFrame frame = source->read(i);
        EXPECT_TRUE(frame.stamp > last);
        last = frame.stamp;
        EXPECT_EQ(frame.color.width(), 320);
        EXPECT_EQ(frame.depth.height(), 240);
    }
    options.camera_file = folder.write("d.yaml", "fx: 300\nfy: 300\ncx: 160\ncy: 120\nwidth: 640\nheight: 480\n");
    EXPECT_TRUE(
        has(message_of<Error>([&] { (void)open_source("openni2:Dummy", options)->read(0); }), "is not of the size"));
}

#else

TEST(OpenNi, IsSaidToBeAbsent) { EXPECT_TRUE(has(open_fault("openni2:"), "built without OpenNI2")); }

#endif

}  // namespace
}  // namespace posefusion::test
