// What the engine gives to those who draw with its device, and what may be changed while it runs.
#include <atomic>
#include <thread>

#include "engine/core/error.hpp"
#include "engine/map/map_reader.hpp"
#include "engine/slam/map_snapshot.hpp"
#include "engine/slam/snapshot_surfels.hpp"
#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/reference.hpp"
#include "tests/engine/support/synthetic_room.hpp"

namespace posefusion::test {
namespace {

using namespace vulkan;

std::vector<Isometry3d> short_path(int frames = 6) {
    return path_to(motion({0.06, -0.03, 0.05}, {1, 2, -1}, 8), frames);
}

DeviceSharing drawing() {
    DeviceSharing sharing;
    sharing.graphics = true;
    return sharing;
}

template <class T>
std::vector<T> read_back(const MapSnapshot& snapshot, const Buffer& buffer, std::size_t count) {
    const Buffer host = host_buffer<T>(*snapshot.context, count, "read back");
    Sequence sequence(*snapshot.context);
    sequence.copy(buffer, host, count * sizeof(T));
    sequence.finish();
    sequence.run();
    return {host.host<T>().begin(), host.host<T>().begin() + static_cast<std::ptrdiff_t>(count)};
}

std::size_t alive(const MapSnapshot& snapshot) {
    const auto positions = read_back<gpu::vec4>(snapshot, snapshot.surfels.position_confidence, snapshot.slots);
    return static_cast<std::size_t>(
        std::count_if(positions.begin(), positions.end(), [](const auto& p) { return p.w > 0; }));
}

class Snapshot : public SlamTest {
protected:
    static FrameResult process(Slam& slam, const Isometry3d& pose) {
        const Frame frame = render_room(kSmall, pose);
        return slam.process(frame.color, frame.depth);
    }
};

TEST_F(Snapshot, IsTheMapAndTheImagesOfTheNewestFrame) {
    Slam slam(kSmall, test_config(), test_device(), drawing());
    EXPECT_EQ(slam.snapshot(), nullptr) << "there is no frame yet";
    const auto path = short_path();
    for (const auto& pose : path) (void)process(slam, pose);
    const auto snapshot = slam.snapshot();
    ASSERT_NE(snapshot, nullptr);
    EXPECT_EQ(snapshot->frame + 1, path.size());

    const auto positions = read_back<gpu::vec4>(*snapshot, snapshot->surfels.position_confidence, snapshot->slots);
    const auto normals = read_back<gpu::vec4>(*snapshot, snapshot->surfels.normal_radius, snapshot->slots);
    std::size_t i = 0;
    for (const Surfel& surfel : slam.surfels(false)) {
        while (i < positions.size() && positions[i].w <= 0) ++i;
        ASSERT_LT(i, positions.size());
        EXPECT_EQ(surfel.position, Eigen::Vector3f(positions[i].x, positions[i].y, positions[i].z));
        EXPECT_EQ(surfel.confidence, positions[i].w);
        EXPECT_EQ(surfel.normal, Eigen::Vector3f(normals[i].x, normals[i].y, normals[i].z));
        ++i;
    }

    const Frame last = render_room(kSmall, path.back());
    const auto colors = read_back<std::uint32_t>(*snapshot, snapshot->color, last.color.size());
    const auto depths = read_back<float>(*snapshot, snapshot->depth, last.color.size());
    for (std::size_t p = 0; p < colors.size(); ++p) {
        const Rgb8 c = last.color[p];
        ASSERT_EQ(colors[p], pack_rgb(c));
        ASSERT_EQ(depths[p], last.depth[p]);
    }
    const auto predicted = read_back<float>(*snapshot, snapshot->model_depth, last.color.size());
    EXPECT_GT(std::count_if(predicted.begin(), predicted.end(), [](float z) { return z > 0; }),
              static_cast<std::ptrdiff_t>(predicted.size() / 2));
}

TEST_F(Snapshot, IsTheSameNeverTwiceAndStaysWhileTheMapGoesOn) {
    Slam slam(kSmall, test_config(), test_device(), drawing());
    const auto path = short_path();
    const FrameResult first = process(slam, path[0]);
    const auto held = slam.snapshot();
    ASSERT_NE(held, nullptr);
    EXPECT_EQ(slam.snapshot(), nullptr) << "there is no newer one";
    for (std::size_t i = 1; i < path.size(); ++i) (void)process(slam, path[i]);
    EXPECT_EQ(alive(*held), first.surfels) << "of the first frame for as long as somebody holds it";
    const auto newer = slam.snapshot();
    ASSERT_NE(newer, nullptr);
    EXPECT_GT(newer->frame, held->frame);
}

TEST_F(Snapshot, OutlivesTheEngine) {
    std::shared_ptr<const MapSnapshot> held;
    std::size_t surfels = 0;
    {
        Slam slam(kSmall, test_config(), test_device(), drawing());
        surfels = process(slam, Isometry3d::Identity()).surfels;
        held = slam.snapshot();
    }
    ASSERT_NE(held, nullptr);
    EXPECT_EQ(alive(*held), surfels);
}

TEST_F(Snapshot, WhoeverWatchesChangesNothingAndNeverSeesHalfAFrame) {
    const auto path = short_path(12);
    Slam slam(kSmall, test_config(), test_device(), drawing());
    std::atomic<bool> done = false;
    std::vector<std::pair<std::uint32_t, std::size_t>> seen;  // frame, surfels
    std::thread watcher([&] {
        while (!done) {
            if (const auto snapshot = slam.snapshot()) seen.emplace_back(snapshot->frame, alive(*snapshot));
        }
    });
    Recording watched;
    for (const auto& pose : path) watched.results.push_back(process(slam, pose));
    done = true;
    watcher.join();
    watched.surfels = slam.surfels(false);
    EXPECT_EQ(watched.bytes(), run_slam(kSmall, test_config(), path).bytes());
    EXPECT_EQ(slam.validation_messages(), 0u);
    ASSERT_FALSE(seen.empty());
    for (std::size_t i = 0; i < seen.size(); ++i) {
        EXPECT_EQ(seen[i].second, watched.results[seen[i].first].surfels) << "frame " << seen[i].first;
        if (i > 0) {
            EXPECT_GT(seen[i].first, seen[i - 1].first);
        }
    }
}

TEST_F(Snapshot, TheirMemoryIsUsedAgain) {
    Slam slam(kSmall, test_config(), test_device(), drawing());
    std::uint64_t after_few = 0;
    const auto path = short_path(12);
    for (std::size_t i = 0; i < path.size(); ++i) {
        const FrameResult result = process(slam, path[i]);
        const auto snapshot = slam.snapshot();
        ASSERT_NE(snapshot, nullptr);
        if (i == 3) after_few = result.device_bytes;
        if (i > 3) {
            EXPECT_EQ(result.device_bytes, after_few) << "frame " << i;
        }
    }
}

TEST_F(Snapshot, ResetStartsAnewAndGivesTheSameBytes) {
    const auto path = short_path();
    Slam slam(kSmall, test_config(), test_device(), drawing());
    for (const auto& pose : path) (void)process(slam, pose);
    (void)slam.snapshot();
    (void)process(slam, path.back());
    slam.reset();
    EXPECT_EQ(slam.snapshot(), nullptr) << "the map before the reset is of no interest";
    EXPECT_TRUE(slam.surfels(false).empty());
    Recording again;
    for (const auto& pose : path) again.results.push_back(process(slam, pose));
    again.surfels = slam.surfels(false);
    EXPECT_EQ(again.bytes(), run_slam(kSmall, test_config(), path).bytes());
}

TEST_F(Snapshot, NewParametersTakeEffectWithTheNextFrame) {
    Slam slam(kSmall, test_config(), test_device());
    const auto path = short_path();
    (void)process(slam, path[0]);
    const FrameResult before = process(slam, path[1]);
    SlamConfig near = test_config();
    near.preprocess.depth_max = 1.5f;
    near.map.stable_confidence = 0.5f;
    slam.set_config(near);
    const FrameResult after = process(slam, path[1]);
    EXPECT_GT(after.valid_pixels, 0u);
    EXPECT_LT(after.valid_pixels, before.valid_pixels / 2) << "the room is 1 to 3 m away";
    EXPECT_GT(after.stable_surfels, before.stable_surfels);
    EXPECT_EQ(slam.surfels(true).size(), after.stable_surfels) << "surfels() knows the new limit, too";
    slam.set_config(test_config());
    EXPECT_EQ(process(slam, path[1]).valid_pixels, before.valid_pixels);
}

TEST_F(Snapshot, TheSameParametersChangeNothing) {
    const auto path = short_path();
    Slam slam(kSmall, test_config(), test_device());
    Recording told;
    for (const auto& pose : path) {
        slam.set_config(test_config());
        told.results.push_back(process(slam, pose));
    }
    told.surfels = slam.surfels(false);
    EXPECT_EQ(told.bytes(), run_slam(kSmall, test_config(), path).bytes());
}

TEST_F(Snapshot, ADeviceWithoutWhatARendererNeedsIsRefusedByName) {
    DeviceSharing sharing;
    sharing.device_extensions = {"VK_NO_such_extension"};
    try {
        Slam slam(kSmall, test_config(), test_device(), sharing);
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_NE(std::string(error.what()).find("lacks VK_NO_such_extension"), std::string::npos) << error.what();
    }
}

bool same(const Surfel& a, const Surfel& b) {
    return a.position == b.position && a.normal == b.normal && a.color == b.color && a.radius == b.radius &&
           a.confidence == b.confidence && a.created == b.created && a.last_seen == b.last_seen;
}

TEST_F(Snapshot, ItsSurfelsAreReadWhileTheMapGoesOn) {
    Slam slam(kSmall, test_config(), test_device());  // nobody draws: the device is not shared
    const auto path = short_path();
    for (std::size_t i = 0; i + 1 < path.size(); ++i) (void)process(slam, path[i]);
    const auto snapshot = slam.snapshot();
    ASSERT_NE(snapshot, nullptr);
    const auto all = slam.surfels(false);
    constexpr float kLeast = 2;  // some have been seen more often, others not
    std::vector<Surfel> often;
    std::copy_if(all.begin(), all.end(), std::back_inserter(often),
                 [](const Surfel& surfel) { return surfel.confidence >= kLeast; });
    ASSERT_FALSE(often.empty());
    ASSERT_GT(all.size(), often.size());
    (void)process(slam, path.back());
    for (const std::uint32_t slice : {1'000u, 1'023u, snapshot->slots, snapshot->slots + 7}) {
        const auto read = read_surfels(*snapshot->context, snapshot->surfels, snapshot->slots, 0, slice);
        ASSERT_EQ(read.size(), all.size()) << slice;
        EXPECT_TRUE(std::equal(read.begin(), read.end(), all.begin(), same)) << slice;
    }
    const auto read = read_surfels(*snapshot, kLeast);
    ASSERT_EQ(read.size(), often.size());
    EXPECT_TRUE(std::equal(read.begin(), read.end(), often.begin(), same));
}

}  // namespace
}  // namespace posefusion::test
