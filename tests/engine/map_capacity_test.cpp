#include "engine/core/error.hpp"
#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/reference.hpp"
#include "tests/engine/support/synthetic_room.hpp"

// Memory grows with the map, and what the map holds does not depend on how it grew.
namespace posefusion::test {
namespace {

class MapCapacity : public SlamTest {
protected:
    const std::vector<Isometry3d> path = path_to(motion({0.25, 0.02, -0.05}, {0.2, 1, 0}, 50), 18);
};

TEST_F(MapCapacity, GrowthFromATinyPoolGivesTheSameMapAsALargePool) {
    SlamConfig tiny = test_config(), large = test_config();
    tiny.map.initial_capacity = 1;
    large.map.initial_capacity = 1u << 19;
    const Recording grown = run_slam(kSmall, tiny, path), roomy = run_slam(kSmall, large, path);
    EXPECT_GT(grown.surfels.size(), 5u * 160 * 120 / 4)
        << "one frame more must not fit into the first pool of two frames";
    EXPECT_EQ(grown.bytes(), roomy.bytes());
}

TEST_F(MapCapacity, DeviceMemoryIsReportedAndFollowsTheCapacity) {
    SlamConfig small = test_config(), large = test_config();
    small.map.initial_capacity = 1;
    large.map.initial_capacity = 1u << 21;
    const auto bytes = [&](const SlamConfig& config) {
        return run_slam(kSmall, config, {path[0]}).results[0].device_bytes;
    };
    const auto few = bytes(small), many = bytes(large);
    EXPECT_GT(few, 0u);
    EXPECT_GE(many, few + (3u * 16 << 21) - (64u << 20));  // three streams of 16 bytes; small pools share blocks
}

TEST_F(MapCapacity, DroppingDeadSlotsKeepsTheOrderOfTheLiveOnes) {
    // a ball seen for a few frames dies; its slots, more than a quarter of all, are dropped by and by
    Slam slam(kSmall, test_config(), test_device());
    const Ball ball{{0, 0.1, 1.0}, 0.28};
    const Frame with = render_room(kSmall, Isometry3d::Identity(), ball),
                without = render_room(kSmall, Isometry3d::Identity());
    for (int k = 0; k < 2; ++k) slam.process(with.color, with.depth);
    for (int k = 0; k < 12; ++k) {
        slam.process(without.color, without.depth);
        std::uint32_t created = 0;
        for (const auto& s : slam.surfels(false)) {
            ASSERT_GE(s.created, created)
                << "the order of creation was lost";  // appended frame by frame, so it never falls
            created = s.created;
        }
    }
    const auto surfels = slam.surfels(false);
    std::size_t floating = 0;
    for (const auto& s : surfels) floating += distance_to_room(s.position.cast<double>()) > 0.06;
    EXPECT_LE(floating, 3u);
}

TEST_F(MapCapacity, FullMapIsAnErrorThatKeepsWhatThereIs) {
    SlamConfig config = test_config();
    config.map.initial_capacity = 1;
    config.map.max_capacity = 45000;
    Slam slam(kSmall, config, test_device());
    std::string message;
    std::size_t frames = 0;
    std::uint32_t surfels = 0;
    for (const auto& pose : path_to(motion({0.25, 0.02, -0.05}, {0.2, 1, 0}, 90), 32)) {
        const Frame frame = render_room(kSmall, pose);
        try {
            surfels = slam.process(frame.color, frame.depth).surfels;
            ++frames;
        } catch (const Error& error) {
            message = error.what();
            break;
        }
    }
    EXPECT_GE(frames, 2u);
    EXPECT_NE(message.find("45000"), std::string::npos) << message;
    EXPECT_NE(message.find("max_capacity"), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos);
    EXPECT_EQ(slam.surfels(false).size(), surfels);
    EXPECT_GT(surfels, 45000u - 160 * 120);
}

}  // namespace
}  // namespace posefusion::test
