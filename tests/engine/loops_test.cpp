#include <algorithm>
#include <cmath>
#include <cstring>
#include <optional>

#include "engine/slam/slam_state.hpp"
#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/reference.hpp"
#include "tests/engine/support/synthetic_room.hpp"

// The back end in the whole engine: old places are taken up again, lost cameras are found, nothing is found where
// nothing is.
namespace posefusion::test {
namespace {

/// A percent of the way round a room 4.5 m wide at 160x120 (see known_motion_test.cpp for what tracking alone drifts).
constexpr double kMaxError = 0.03;

/// Camera on a circle of 0.3 m, looking outwards, `degrees` from the start.
Isometry3d around(double degrees) {
    const Isometry3d turn = motion({0, 0, 0}, {0, 1, 0}, degrees), out = motion({0, 0, 0.3}, {0, 1, 0}, 0);
    return out.inverse() * turn * out;
}

class BackEndTest : public SlamTest {
protected:
    static double error(const Isometry3d& truth, const Isometry3d& estimate) {
        return (truth.inverse() * estimate).translation().norm();
    }
    FrameResult see(Slam& slam, const Isometry3d& pose) const {
        const Frame frame = render_room(kSmall, pose);
        return slam.process(frame.color, frame.depth);
    }
    static SlamConfig config_with_short_window() {
        SlamConfig config = test_config();
        config.loops.time_window = 50;
        config.loops.interval = 3;
        config.map.stable_confidence = 4;  // a place is seen for few frames here
        return config;
    }
};

TEST_F(BackEndTest, ComingRoundTheOldPlaceIsTakenUpAgain) {
    Slam slam(kSmall, config_with_short_window(), test_device());
    std::vector<Isometry3d> path;
    for (int k = 0; k < 200; ++k) path.push_back(around(2.0 * k));
    std::vector<LoopEvent> closed;
    for (const auto& pose : path) {
        const FrameResult result = see(slam, pose);
        EXPECT_EQ(result.tracking, &pose == &path.front() ? TrackingState::FirstFrame : TrackingState::Ok)
            << &pose - path.data() << " inliers " << result.icp_inliers << " photo " << result.photometric_inliers
            << " of " << result.valid_pixels << " err " << error(pose, result.T_world_camera);
        for (const LoopEvent& event : result.loops) {
            if (event.accepted) closed.push_back(event);
        }
    }
    ASSERT_FALSE(closed.empty()) << "the camera has come back to its start";
    for (const LoopEvent& event : closed) {
        EXPECT_GT(event.frame, 140u) << "nothing can be revisited before";
        EXPECT_LT(event.model_frame, event.frame - 50);
        EXPECT_TRUE(event.reason.empty()) << event.reason;
    }
    const auto trajectory = slam.trajectory();
    ASSERT_EQ(trajectory.size(), path.size());
    for (std::size_t k = 0; k < path.size(); ++k) EXPECT_LT(error(path[k], trajectory[k]), kMaxError) << k;

    const auto keyframes = slam.keyframes();
    ASSERT_GT(keyframes.size(), 3u);
    EXPECT_TRUE(std::is_sorted(keyframes.begin(), keyframes.end()));
    EXPECT_LT(keyframes.back(), path.size());
}

TEST_F(BackEndTest, TheGraphOfTheLastLoopCanBeLookedAt) {
    SlamConfig config = config_with_short_window();
    config.loops.min_discrepancy = 0;  // every loop bends the map
    Slam slam(kSmall, config, test_device());
    std::optional<LoopEvent> last;
    for (int k = 0; k < 200; ++k) {
        for (const LoopEvent& event : see(slam, around(2.0 * k)).loops) {
            if (event.accepted && event.nodes > 0) last = event;
        }
        EXPECT_EQ(slam.loop_graph().has_value(), last.has_value()) << k;
    }
    ASSERT_TRUE(last) << "the camera has come back to its start";
    const LoopGraph graph = *slam.loop_graph();
    EXPECT_EQ(graph.frame, last->frame);
    EXPECT_EQ(graph.map_nodes, last->nodes);
    EXPECT_GT(graph.nodes.size(), graph.map_nodes) << "cameras are nodes, too";
    ASSERT_FALSE(graph.edges.empty());
    for (const auto& [a, b] : graph.edges) EXPECT_LT(std::max(a, b), graph.nodes.size());

    // The nodes lie in the map as it is now.
    const std::vector<Surfel> map = slam.surfels(false);
    for (std::uint32_t i = 0; i < graph.map_nodes; ++i) {
        const auto distance = [&](const Surfel& s) {
            return (s.position.cast<double>() - graph.nodes[i].position).norm();
        };
        const auto nearest = std::min_element(map.begin(), map.end(),
                                              [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
        EXPECT_LT(distance(*nearest), 0.1) << "node " << i;
        EXPECT_LT(graph.nodes[i].moved.norm(), 0.2) << "node " << i;
    }
    slam.restore(slam.state());
    EXPECT_FALSE(slam.loop_graph()) << "of this run only";
}

TEST_F(BackEndTest, WhatIsTooFarForDriftIsAnotherPlace) {
    SlamConfig config = config_with_short_window();
    config.loops.min_discrepancy = 0;                             // every loop bends the map ...
    config.loops.max_drift = config.loops.max_drift_at_rest = 0;  // ... but nothing drifts
    Slam slam(kSmall, config, test_device());
    std::size_t refused = 0;
    std::vector<Isometry3d> live;
    for (int k = 0; k < 200; ++k) {
        const FrameResult result = see(slam, around(2.0 * k));
        live.push_back(result.T_world_camera);
        for (const LoopEvent& event : result.loops) {
            EXPECT_FALSE(event.accepted);
            if (event.residual_before_m == 0) continue;
            EXPECT_NE(event.reason.find("too far for drift"), std::string::npos) << event.reason;
            ++refused;
        }
    }
    EXPECT_GT(refused, 0u) << "the camera has come back to its start";
    const auto trajectory = slam.trajectory();
    for (std::size_t k = 0; k < live.size(); ++k) ASSERT_EQ(trajectory[k].matrix(), live[k].matrix()) << k;
}

TEST_F(BackEndTest, ARestoredEngineClosesTheSameLoopsByteByByte) {
    constexpr int kFrames = 230, kBefore = 120;
    SlamConfig config = config_with_short_window();
    config.loops.min_discrepancy = 0;  // every loop bends the map
    const auto bends = [](const FrameResult& result) {
        return std::any_of(result.loops.begin(), result.loops.end(),
                           [](const LoopEvent& event) { return event.accepted && event.nodes > 0; });
    };
    Slam slam(kSmall, config, test_device());
    std::vector<std::pair<int, SlamState>> states;  // next frame, state: before the first loop, right after it
    int loops = 0;
    for (int k = 0; k < kFrames; ++k) {
        if (k == kBefore) states.emplace_back(k, slam.state());
        if (!bends(see(slam, around(2.0 * k)))) continue;
        EXPECT_GT(k, kBefore);
        if (loops++ == 0) states.emplace_back(k + 1, slam.state());
    }
    ASSERT_EQ(states.size(), 2u) << "the camera has come back to its start";
    ASSERT_GT(loops, 1) << "the second state needs a loop to come, tied by what was kept from the first";
    EXPECT_FALSE(states[1].second.back_end.relative_constraints.empty());
    const auto bytes = [](Slam& of) {
        Recording run;
        run.surfels = of.surfels(false);
        return run.bytes();
    };
    for (const auto& [next, state] : states) {
        Slam restored(kSmall, config, test_device());
        restored.restore(state);
        int closed = 0;
        for (int k = next; k < kFrames; ++k) closed += bends(see(restored, around(2.0 * k)));
        EXPECT_EQ(closed, next == kBefore ? loops : loops - 1);
        EXPECT_EQ(bytes(restored), bytes(slam)) << "from frame " << next;
        const auto trajectory = restored.trajectory(), expected = slam.trajectory();
        ASSERT_EQ(trajectory.size(), expected.size());
        for (std::size_t k = 0; k < expected.size(); ++k)
            ASSERT_EQ(std::memcmp(trajectory[k].data(), expected[k].data(), 16 * sizeof(double)), 0) << k;
    }
}

TEST_F(BackEndTest, WithoutLoopsNothingIsClosedAndTheTrajectoryIsWhatTrackingSaid) {
    SlamConfig config = config_with_short_window();
    config.loops.enabled = false;
    Slam slam(kSmall, config, test_device());
    std::vector<Isometry3d> live;
    for (int k = 0; k < 40; ++k) {
        const FrameResult result = see(slam, around(2.0 * k));
        EXPECT_TRUE(result.loops.empty());
        EXPECT_EQ(result.T_world_tracked.matrix(), result.T_world_camera.matrix()) << "nothing was corrected";
        live.push_back(result.T_world_camera);
    }
    const auto trajectory = slam.trajectory();
    ASSERT_EQ(trajectory.size(), live.size());
    for (std::size_t k = 0; k < live.size(); ++k) EXPECT_EQ(trajectory[k].matrix(), live[k].matrix());
}

class Kidnapped : public BackEndTest {
protected:
    static constexpr int kFrames = 50;
    static Isometry3d seen_at(int k) { return around(1.5 * k); }
    /// Maps part of the room, covers the camera, uncovers it elsewhere.
    struct Found {
        int after = -1;  ///< frames; -1 = never
        double error = 0;
        bool wrong = false;  ///< a pose far off was believed
    };
    /// @param by_features  where other means find the camera; nullopt: nowhere
    Found kidnap_to(const Isometry3d& place, int patience, const std::optional<Isometry3d>& by_features = {}) const {
        Slam slam(kSmall, test_config(), test_device());
        for (int k = 0; k < kFrames; ++k) see(slam, seen_at(k));
        const Frame dark{ColorImage(kSmall.width, kSmall.height), DepthImage(kSmall.width, kSmall.height, 0.0f), {}};
        const FrameResult covered = slam.process(dark.color, dark.depth);
        EXPECT_EQ(covered.tracking, TrackingState::Failed);
        Found found;
        Isometry3d last = covered.T_world_camera;
        const Frame frame = render_room(kSmall, place);
        constexpr int kEarlier = 10;
        for (int k = 0; k < patience; ++k) {
            StartPose start;
            start.age = static_cast<std::uint32_t>(kFrames + 1 + k - kEarlier);
            if (by_features) start.T_earlier_current = seen_at(kEarlier).inverse() * *by_features;
            const FrameResult result =
                slam.process(frame.color, frame.depth, {}, {}, std::span(&start, by_features ? 1 : 0));
            EXPECT_LT(error(last, result.T_world_tracked), kMaxError) << k << ": to be found elsewhere is no motion";
            last = result.T_world_camera;
            const bool tracked = has_pose(result.tracking);
            if (!tracked) {
                EXPECT_EQ(result.surfels, covered.surfels) << "a lost camera must not touch the map";
                EXPECT_EQ(result.tracking,
                          k + 2 >= RelocalisationConfig{}.lost_after ? TrackingState::Lost : TrackingState::Failed);
                continue;
            }
            found.error = error(place, result.T_world_camera);
            found.wrong = found.wrong || found.error > 0.1;
            if (found.after < 0) found.after = k;
        }
        return found;
    }
};

TEST_F(Kidnapped, IsFoundWhereItHasBeenBefore) {
    const Isometry3d place = seen_at(10) * motion({0.04, -0.02, 0.05}, {1, -2, 0.5}, 3);
    const Found found = kidnap_to(place, 16);
    EXPECT_GE(found.after, 0) << "not found";
    EXPECT_LT(found.error, kMaxError);
    EXPECT_FALSE(found.wrong);
}

TEST_F(Kidnapped, IsFoundFromAViewThatNoKeyframeResemblesByWhatIsKnownFromOutside) {
    // the mapped surfaces from the side: only a pose leads there, no likeness of the whole view
    const Isometry3d place = seen_at(25) * motion({0.5, 0.2, 0.4}, {0.2, -1, 1}, 32);
    EXPECT_EQ(kidnap_to(place, 24).after, -1) << "then it needs no help";
    const Found found = kidnap_to(place, 24, place * motion({0.01, -0.01, 0.01}, {1, 1, 0}, 0.5));
    ASSERT_GE(found.after, 0) << "not found";
    EXPECT_LE(found.after, 14) << "it is tried on every other frame, and confirmed by the next";
    EXPECT_LT(found.error, kMaxError);
    EXPECT_FALSE(found.wrong);
}

TEST_F(Kidnapped, WhatIsWrongFromOutsideIsNotBelieved) {
    const Isometry3d place = seen_at(10);
    const Found found = kidnap_to(place, 24, seen_at(40));
    EXPECT_GE(found.after, 0) << "the keyframes are tried, too";
    EXPECT_FALSE(found.wrong);
}

TEST_F(Kidnapped, IsNotFoundWhereItHasNeverBeen) {
    const Found found = kidnap_to(around(230), 16);
    EXPECT_EQ(found.after, -1) << "the room was not mapped there; error " << found.error << " m";
    EXPECT_FALSE(found.wrong);
}

TEST_F(Kidnapped, AnotherPlaceOfTheSameShapeIsNotTakenForTheLostOne) {
    SlamConfig config = test_config();
    config.pieces.begin_after = 0;
    Slam slam(kSmall, config, test_device());
    for (int k = 0; k < kFrames; ++k) see(slam, seen_at(k));
    const Isometry3d place = seen_at(kFrames - 1);
    Frame frame = render_room(kSmall, place);
    const Frame dark{ColorImage(kSmall.width, kSmall.height), DepthImage(kSmall.width, kSmall.height, 0.0f), {}};
    for (int k = 0; k < config.relocalisation.lost_after; ++k) (void)slam.process(dark.color, dark.depth);
    constexpr int kTile = 8;  // pixels
    for (int v = 0; v < kSmall.height; ++v) {
        for (int u = 0; u < kSmall.width; ++u) {
            const auto grey = static_cast<std::uint8_t>((u / kTile * 97 + v / kTile * 57) % 256);
            frame.color(u, v) = {grey, grey, grey};
        }
    }
    for (int k = 0; k < 12; ++k) {
        const FrameResult result = slam.process(frame.color, frame.depth);
        EXPECT_EQ(result.tracking, TrackingState::Lost) << k << ": every point fits, but no colour";
    }
    for (int k = 0; k < 6; ++k) (void)see(slam, place);
    EXPECT_TRUE(has_pose(see(slam, place).tracking)) << "the place itself is found";
}

TEST_F(BackEndTest, PeopleAllOverTheViewCannotMakeTheCameraJump) {
    Slam slam(kSmall, test_config(), test_device());
    for (int k = 0; k < 6; ++k) see(slam, Isometry3d::Identity());
    Isometry3d last = Isometry3d::Identity();
    for (int k = 0; k < 12; ++k) {
        Frame frame = render_room(kSmall, Isometry3d::Identity(), Ball{{0.05 * k - 0.3, 0.0, 0.6}, 0.3});
        for (int v = 0; v < kSmall.height; ++v) {
            for (int u = 0; u < kSmall.width; ++u)
                frame.labels(u, v) = u > 23 || frame.labels(u, v) ? 1 : 0;  // a strip is left
        }
        const FrameResult result = slam.process(frame.color, frame.depth, frame.labels);
        EXPECT_LT((last.inverse() * result.T_world_camera).translation().norm(), 0.03) << k;  // at most a drift
        EXPECT_LT(result.T_world_camera.translation().norm(), 0.1) << k;
        last = result.T_world_camera;
        EXPECT_NE(result.tracking, TrackingState::Relocalised);
    }
}

}  // namespace
}  // namespace posefusion::test
