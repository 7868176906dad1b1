#include "hosts/io/recording.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "engine/core/error.hpp"
#include "hosts/io/image_file.hpp"
#include "hosts/synth/synth.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

SynthConfig tiny(const std::filesystem::path& out) {
    SynthConfig config;
    config.out = out;
    config.width = 96;
    config.height = 72;
    config.frames = 3;
    config.people = 1;
    return config;
}

TEST(SynthRecording, ReadsBackAsARecording) {
    const test::TempFolder folder;
    const SynthConfig config = tiny(folder / "made");
    std::vector<int> told;
    synthesize(config, [&](int done, int total) {
        EXPECT_EQ(total, 3);
        told.push_back(done);
        return true;
    });
    EXPECT_EQ(told, (std::vector<int>{1, 2, 3}));
    const Recording recording(config.out);
    EXPECT_TRUE(recording.warnings().empty());
    ASSERT_EQ(recording.size(), 3u);
    const auto truth = recording.groundtruth();
    ASSERT_TRUE(truth.has_value());
    ASSERT_EQ(truth->size(), 3u);
    const SynthWorld world(config);
    EXPECT_FLOAT_EQ(recording.intrinsics().fx, world.camera().fx);
    for (int i = 0; i < 3; ++i) {
        const SynthFrame made = world.render(i);
        const auto k = static_cast<std::size_t>(i);
        const Frame read = recording.load(k);
        EXPECT_LT(((*truth)[k].T_world_camera.matrix() - made.T_world_camera.matrix()).norm(), 1e-7);
        EXPECT_NEAR(to_seconds((*truth)[k].stamp), made.stamp, 1e-6);
        double color = 0;
        for (std::size_t p = 0; p < made.depth.size(); ++p) {
            ASSERT_NEAR(read.depth[p], made.depth[p], 1.01e-4f);
            color += std::abs(read.color[p].g - made.color[p].g);
        }
        EXPECT_LT(color / static_cast<double>(made.depth.size()), 4) << "JPEG changes colours a little";
        char stamp[32];
        std::snprintf(stamp, sizeof stamp, "%.6f.png", made.stamp);
        const LabelImage labels = read_labels(config.out / "masks" / stamp, {config.width, config.height});
        EXPECT_TRUE(std::equal(labels.begin(), labels.end(), made.labels.begin()));
    }
    for (const char* file :
         {"rgb.txt", "depth.txt", "masks.txt", "associations.txt", "joints.json", "camera.yaml", "info.json"})
        EXPECT_TRUE(std::filesystem::is_regular_file(config.out / file)) << file;
}

TEST(SynthRecording, StoppedEarlyItIsAShorterRecording) {
    const test::TempFolder folder;
    const SynthConfig config = tiny(folder / "made");
    synthesize(config, [](int done, int) { return done < 2; });
    EXPECT_EQ(Recording(config.out).size(), 2u);
}

TEST(SynthRecording, SaysWhenItCannotWrite) {
    const test::TempFolder folder;
    folder.write("file", "in the way");
    EXPECT_THROW(synthesize(tiny(folder / "file")), Error);
    EXPECT_THROW(synthesize(tiny({})), Error);
}

}  // namespace
}  // namespace posefusion
