#include <algorithm>
#include <cstring>

#include "engine/core/error.hpp"
#include "engine/slam/slam_state.hpp"
#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/reference.hpp"
#include "tests/engine/support/synthetic_room.hpp"

// A restored engine goes on as if nothing had happened; one that only localises leaves the map alone.
namespace posefusion::test {
namespace {

constexpr std::size_t kFrames = 12, kStateAt = 6;

std::vector<Isometry3d> walk() { return path_to(motion({0.10, -0.05, 0.08}, {1, 2, -1}, 12), kFrames); }

/// A configuration in which every part of the back end has something to keep within a few frames.
SlamConfig busy_config() {
    SlamConfig config = test_config();
    config.loops.time_window = 10;
    config.loops.interval = 1;
    config.loops.ferns.keyframe_dissimilarity = 0.05f;
    return config;
}

FrameResult feed(Slam& slam, const Isometry3d& pose) {
    const Frame frame = render_room(kSmall, pose);
    return slam.process(frame.color, frame.depth);
}

Recording feed(Slam& slam, std::size_t begin, std::size_t end) {
    Recording run;
    for (std::size_t k = begin; k < end; ++k) run.results.push_back(feed(slam, walk()[k]));
    run.surfels = slam.surfels(false);
    return run;
}

bool equal(const MapState& a, const MapState& b) {
    return a.slots == b.slots && a.counters == b.counters && a.position_confidence == b.position_confidence &&
           a.normal_radius == b.normal_radius && a.appearance == b.appearance;
}

std::string error_of(auto&& call) {
    try {
        call();
    } catch (const Error& error) {
        return error.what();
    }
    return {};
}

class StateTest : public SlamTest {
protected:
    /// Taken after kStateAt frames; `rest` is what the same engine makes of the others.
    void take(const SlamConfig& config) {
        Slam slam(kSmall, config, test_device());
        (void)feed(slam, 0, kStateAt);
        state = slam.state();
        rest = feed(slam, kStateAt, kFrames);
        trajectory = slam.trajectory();
    }
    SlamState state;
    Recording rest;
    std::vector<Isometry3d> trajectory;
};

TEST_F(StateTest, ARestoredEngineGoesOnByteByByte) {
    take(busy_config());
    EXPECT_EQ(state.frames, kStateAt);
    EXPECT_GT(state.back_end.keyframes.size(), 1u) << "the test needs a back end with something in it";
    Slam slam(kSmall, busy_config(), test_device());
    slam.restore(state);
    EXPECT_EQ(feed(slam, kStateAt, kFrames).bytes(), rest.bytes());
    const auto restored = slam.trajectory();
    ASSERT_EQ(restored.size(), trajectory.size());
    for (std::size_t k = 0; k < restored.size(); ++k) {
        EXPECT_EQ(std::memcmp(restored[k].data(), trajectory[k].data(), 16 * sizeof(double)), 0) << k;
    }
}

TEST_F(StateTest, AlsoOverAnotherMapAndWithAnotherCapacity) {
    take(busy_config());
    SlamConfig small = busy_config();
    small.map.initial_capacity = 1024;
    Slam slam(kSmall, small, test_device());
    for (int k = 0; k < 2; ++k) (void)feed(slam, motion({-0.1, 0, 0}, {0, 1, 0}, -3));  // to be replaced
    slam.restore(state);
    EXPECT_EQ(feed(slam, kStateAt, kFrames).bytes(), rest.bytes());
}

TEST_F(StateTest, AskingForTheStateChangesNothing) {
    take(busy_config());
    Slam slam(kSmall, busy_config(), test_device());
    (void)feed(slam, 0, kStateAt);
    EXPECT_EQ(feed(slam, kStateAt, kFrames).bytes(), rest.bytes());
}

TEST_F(StateTest, EveryPartOfItIsNeeded) {
    take(busy_config());
    Slam slam(kSmall, busy_config(), test_device());
    const auto goes_on_alike_without = [&](auto&& drop) {
        SlamState less = state;
        drop(less);
        slam.restore(less);
        return feed(slam, kStateAt, kFrames).bytes() == rest.bytes();
    };
    const auto clear = [](ByteArray& bytes) { std::fill(bytes.begin(), bytes.end(), std::byte{0}); };
    EXPECT_TRUE(goes_on_alike_without([](SlamState&) {}));
    EXPECT_FALSE(goes_on_alike_without([&](SlamState& s) { clear(s.tracking.previous_live); }));
    EXPECT_FALSE(goes_on_alike_without([&](SlamState& s) { clear(s.tracking.model); }));
    constexpr std::size_t kInX =
        offsetof(gpu::TrackingRecord, world_live) + offsetof(gpu::vec4, w) + 2;  // of the camera's position
    EXPECT_FALSE(goes_on_alike_without([&](SlamState& s) { s.tracking.record[kInX] ^= std::byte{0x10}; }));
    EXPECT_FALSE(goes_on_alike_without([&](SlamState& s) { clear(s.map.appearance); }));
}

TEST_F(StateTest, RefusesWhatDoesNotFit) {
    take(test_config());
    Intrinsics other = kSmall;
    other.fx += 1;
    Slam narrow(other, test_config(), test_device());
    EXPECT_NE(error_of([&] { narrow.restore(state); }).find("another camera"), std::string::npos);

    SlamConfig ferns = test_config();
    ferns.loops.ferns.seed = 2;
    Slam otherwise(kSmall, ferns, test_device());
    EXPECT_NE(error_of([&] { otherwise.restore(state); }).find("loops.fern_seed = 1"), std::string::npos);

    Slam slam(kSmall, test_config(), test_device());
    const auto refused = [&](auto&& spoil) {
        SlamState bad = state;
        spoil(bad);
        return error_of([&] { slam.restore(bad); }).find("contradicts itself") != std::string::npos;
    };
    EXPECT_TRUE(refused([](SlamState& s) { ++s.map.slots; }));
    EXPECT_TRUE(refused([](SlamState& s) { s.map.capacity = s.map.slots - 1; }));
    EXPECT_TRUE(refused([](SlamState& s) { s.map.appearance.pop_back(); }));
    EXPECT_TRUE(refused([](SlamState& s) { s.tracking.model.pop_back(); }));
    EXPECT_TRUE(refused([](SlamState& s) { s.tracking.record.clear(); }));
    EXPECT_TRUE(refused([](SlamState& s) { s.back_end.trajectory.pop_back(); }));
    EXPECT_FALSE(refused([](SlamState&) {}));
}

class LocaliseTest : public SlamTest {
protected:
    static SlamConfig mapping() {
        SlamConfig config = test_config();
        config.loops.ferns.keyframe_dissimilarity = 0.1f;
        return config;
    }
    static SlamConfig localising() {
        SlamConfig config = mapping();
        config.localise_only = true;
        return config;
    }
    /// Long enough for surfels that are stable.
    static SlamState mapped_room() {
        Slam slam(kSmall, mapping(), test_device());
        for (const auto& pose : path_to(motion({0.25, 0, 0}, {0, 1, 0}, -15), 24)) (void)feed(slam, pose);
        return slam.state();
    }
};

TEST_F(LocaliseTest, FindsTheCameraInTheOldMapAndLeavesItAlone) {
    const SlamState map = mapped_room();
    Slam slam(kSmall, localising(), test_device());
    slam.restore(map);
    slam.lose_camera();
    const auto path =
        path_to(motion({0.25, 0, 0}, {0, 1, 0}, -15), 24);  // from its beginning again, far from the last pose
    std::size_t found = path.size();
    for (std::size_t k = 0; k < path.size(); ++k) {
        const FrameResult result = feed(slam, path[k]);
        const bool tracked = has_pose(result.tracking);
        if (tracked) {
            found = std::min(found, k);
            EXPECT_LT((result.T_world_camera.translation() - path[k].translation()).norm(), 0.03) << k;
        }
        if (found < k) {
            EXPECT_TRUE(tracked) << k;
        }
    }
    EXPECT_LE(found, 8u) << "frames until the camera was found";
    const SlamState after = slam.state();
    EXPECT_TRUE(equal(after.map, map.map)) << "the map has changed";
    EXPECT_EQ(after.back_end.keyframes.size(), map.back_end.keyframes.size());
    EXPECT_EQ(after.frames, map.frames + path.size());
}

TEST_F(LocaliseTest, MappingGoesOnAfterTheCameraWasFoundAndNotBefore) {
    const SlamState map = mapped_room();
    Slam slam(kSmall, mapping(), test_device());
    slam.restore(map);
    slam.lose_camera();
    const Frame dark{ColorImage(kSmall.width, kSmall.height), DepthImage(kSmall.width, kSmall.height), {}};
    for (int k = 0; k < 3; ++k) {
        const FrameResult result = slam.process(dark.color, dark.depth);
        EXPECT_EQ(result.tracking, TrackingState::Lost);
        EXPECT_LE(result.surfels, map.map.alive) << "fused without knowing where";
    }
    int tracked = 0;
    for (int k = 0; k < 8; ++k)
        tracked += feed(slam, motion({0.02, 0, 0}, {0, 1, 0}, -1)).tracking == TrackingState::Ok;
    EXPECT_GT(tracked, 0);
    EXPECT_FALSE(equal(slam.state().map, map.map)) << "mapping has not gone on";
}

TEST_F(LocaliseTest, NeedsAMap) {
    Slam slam(kSmall, localising(), test_device());
    EXPECT_NE(error_of([&] { (void)feed(slam, Isometry3d::Identity()); }).find("needs a map"), std::string::npos);
}

TEST(Names, AreThoseThatFilesAndPythonUse) {
    EXPECT_STREQ(name_of(TrackingState::FirstFrame), "first");
    EXPECT_STREQ(name_of(TrackingState::Ok), "ok");
    EXPECT_STREQ(name_of(TrackingState::Failed), "failed");
    EXPECT_STREQ(name_of(TrackingState::Lost), "lost");
    EXPECT_STREQ(name_of(TrackingState::Relocalised), "relocalised");
    EXPECT_STREQ(name_of(LoopKind::Local), "local");
    EXPECT_STREQ(name_of(LoopKind::Global), "global");
    EXPECT_STREQ(name_of(LoopKind::Relocalisation), "relocalisation");
}

}  // namespace
}  // namespace posefusion::test
