#include "tests/hosts/io/sources/frames.hpp"
#include "tests/hosts/support/subprocess.hpp"

namespace posefusion::test {
namespace {

namespace fs = std::filesystem;

/// Recordings made by other people's writers, see make_mcap.js.
class IndependentWriter : public testing::TestWithParam<const char*> {};

TEST_P(IndependentWriter, GivesMcapFilesThatAreRead) {
    if (!fs::exists(POSEFUSION_MCAP_PACKAGES))
        GTEST_SKIP() << POSEFUSION_MCAP_PACKAGES << " is not there; tools/setup fetches it";
    const TempFolder folder;
    Subprocess node({{"/usr/bin/env", "node", POSEFUSION_MAKE_MCAP, folder.path().string()},
                     {{"NODE_PATH", POSEFUSION_MCAP_PACKAGES}}},
                    folder.path());
    ASSERT_EQ(node.exit_code(), 0) << node.error_output();
    const auto source = open_source(folder / GetParam());
    const bool closed = std::string(GetParam()) != "unclosed.mcap";
    EXPECT_EQ(source->facts().warnings.size(), closed ? 0u : 1u);
    ASSERT_GE(source->size(), closed ? 3u : 2u) << "the writer may keep the last chunk";
    const Camera& camera = source->camera();
    EXPECT_EQ(camera.intrinsics.width, 8);
    EXPECT_FLOAT_EQ(camera.intrinsics.fx, 9.5f);
    EXPECT_FLOAT_EQ(camera.intrinsics.cy, 2.5f);
    EXPECT_FLOAT_EQ(camera.distortion[1], -0.2f);
    for (std::size_t i = 0; i < source->size(); ++i) {
        const RawFrame frame = source->read(i);
        EXPECT_NEAR(to_seconds(frame.stamp), 100.5 + static_cast<double>(i) * 0.033333, 1e-9);
        EXPECT_EQ(frame.depth_delay, std::chrono::milliseconds(2));
        EXPECT_EQ(frame.color(5, 4), (Rgb8{50, 80, static_cast<std::uint8_t>(i)}));
        EXPECT_EQ(frame.depth(5, 4), 1000 + 100 * i + 5 + 40);
    }
}
INSTANTIATE_TEST_SUITE_P(All, IndependentWriter,
                         testing::Values("chunks.mcap", "no_index.mcap", "no_summary.mcap", "no_chunks.mcap",
                                         "unclosed.mcap"));

}  // namespace
}  // namespace posefusion::test
