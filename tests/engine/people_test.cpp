#include <cmath>
#include <cstring>

#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/reference.hpp"
#include "tests/engine/support/synthetic_room.hpp"

// What moves and is masked takes no part; what was there before being noticed goes; a covered camera holds its pose.
namespace posefusion::test {
namespace {

// Three quarters of a pixel at 2 m (see known_motion_test.cpp); a person who is tracked along costs centimetres.
constexpr double kMaxError = 11.5e-3, kMaxAngle = 0.35;

class PeopleInTheMap : public SlamTest {
protected:
    static Ball ball_at(double x) { return {Vector3d(x, 0.1, 1.1), 0.25}; }
    /// Surfels that stand in the room rather than on its surfaces.
    static std::size_t floating(const std::vector<Surfel>& surfels) {
        std::size_t count = 0;
        for (const auto& s : surfels) count += distance_to_room(s.position.cast<double>()) > 0.06;
        return count;
    }
    const Intrinsics camera = kSmall;
};

TEST_F(PeopleInTheMap, MaskedMovingObjectDisturbsNeitherPoseNorMap) {
    const auto path = path_to(motion({0.06, -0.02, 0.03}, {1, 2, -1}, 5), 8);
    Slam slam(camera, test_config(), test_device());
    for (std::size_t k = 0; k < path.size(); ++k) {
        const Frame frame = render_room(camera, path[k], ball_at(-0.4 + 0.1 * static_cast<double>(k)));
        const auto result = slam.process(frame.color, frame.depth, frame.labels);
        const Isometry3d error = path[k].inverse() * result.T_world_camera;
        EXPECT_LT(error.translation().norm(), kMaxError) << k;
        EXPECT_LT(angle_deg(error), kMaxAngle) << k;
    }
    EXPECT_EQ(floating(slam.surfels(false)), 0u);
}

TEST_F(PeopleInTheMap, MaskedPixelsNeverCreateSurfels) {
    Slam slam(camera, test_config(), test_device());
    const Frame frame = render_room(camera, Isometry3d::Identity());
    LabelImage labels(camera.width, camera.height, 0);
    for (int v = 30; v < 90; ++v) {
        for (int u = 0; u < 70; ++u) labels(u, v) = 200;
    }
    for (int k = 0; k < 4; ++k) slam.process(frame.color, frame.depth, labels);
    const auto surfels = slam.surfels(false);
    EXPECT_GT(surfels.size(), 10000u);
    for (const auto& s : surfels) {
        const double u = camera.fx * s.position.x() / s.position.z() + camera.cx,
                     v = camera.fy * s.position.y() / s.position.z() + camera.cy;
        ASSERT_FALSE(u > 0 && u < 70 && v > 30 && v < 89) << u << ' ' << v;
    }
}

TEST_F(PeopleInTheMap, SurfelsOfAPersonWhoWasNotNoticedDisappearInFreeSpace) {
    Slam slam(camera, test_config(), test_device());
    const Frame with = render_room(camera, Isometry3d::Identity(), ball_at(0)),
                without = render_room(camera, Isometry3d::Identity());
    for (int k = 0; k < 5; ++k) slam.process(with.color, with.depth);
    EXPECT_GT(floating(slam.surfels(false)), 500u) << "the test needs a person in the map";
    for (int k = 0; k < 12; ++k) slam.process(without.color, without.depth);
    EXPECT_LE(floating(slam.surfels(false)), 3u);
}

TEST_F(PeopleInTheMap, SurfelsOfAPersonDisappearWhereTheMaskUncoversThem) {
    // unmasked at first, then masked and walking away
    Slam slam(camera, test_config(), test_device());
    const Frame first = render_room(camera, Isometry3d::Identity(), ball_at(-0.2));
    for (int k = 0; k < 3; ++k) slam.process(first.color, first.depth);
    EXPECT_GT(floating(slam.surfels(false)), 500u);
    for (int k = 0; k < 16; ++k) {
        const Frame frame = render_room(camera, Isometry3d::Identity(), ball_at(-0.2 + 0.09 * k));
        slam.process(frame.color, frame.depth, frame.labels);
    }
    EXPECT_LE(floating(slam.surfels(false)), 5u);
}

TEST_F(PeopleInTheMap, UnstableSurfelsOfAPersonGoAsSoonAsTheMaskCoversThem) {
    // noticed late, and standing still: nothing is ever seen behind them
    Slam slam(camera, test_config(), test_device());
    const Frame frame = render_room(camera, Isometry3d::Identity(), ball_at(0));
    for (int k = 0; k < 3; ++k) slam.process(frame.color, frame.depth);
    EXPECT_GT(floating(slam.surfels(false)), 500u);
    slam.process(frame.color, frame.depth, frame.labels);
    EXPECT_LE(floating(slam.surfels(false)), 5u);
}

TEST_F(PeopleInTheMap, UnstableSurfelsBehindAndBesideAPersonStay) {
    Slam slam(camera, test_config(), test_device());
    const Frame without = render_room(camera, Isometry3d::Identity()),
                with = render_room(camera, Isometry3d::Identity(), ball_at(0));
    for (int k = 0; k < 3; ++k) slam.process(without.color, without.depth);
    const std::size_t before = slam.surfels(false).size();
    FrameResult after;
    for (int k = 0; k < 3; ++k) after = slam.process(with.color, with.depth, with.labels);
    EXPECT_EQ(after.stable_surfels, 0u) << "the test is about unstable ones";
    EXPECT_GE(after.surfels, before);
}

class CoveredCamera : public PeopleInTheMap {
protected:
    /// Four good frames of a moving camera, a covered one, then on.
    void expect_hold_and_recovery() {
        const auto path = path_to(motion({0.05, -0.02, 0.03}, {1, 2, -1}, 4), 8);
        Slam slam(camera, test_config(), test_device());
        FrameResult before;
        for (std::size_t k = 0; k < 4; ++k) {
            const Frame frame = render_room(camera, path[k]);
            before = slam.process(frame.color, frame.depth);
        }
        const auto map = slam.surfels(false);
        for (int k = 0; k < 3; ++k) {
            const auto held = slam.process(covered.color, covered.depth, covered.labels);
            EXPECT_EQ(held.tracking, TrackingState::Failed);
            EXPECT_EQ(held.T_world_camera.matrix(), before.T_world_camera.matrix());
            EXPECT_EQ(held.surfels, before.surfels);
        }
        const auto after = slam.surfels(false);
        ASSERT_EQ(after.size(), map.size());
        for (std::size_t i = 0; i < map.size(); ++i) {
            ASSERT_EQ(after[i].position, map[i].position);
            ASSERT_EQ(after[i].confidence, map[i].confidence);
            ASSERT_EQ(after[i].last_seen, map[i].last_seen);
        }
        for (std::size_t k = 4; k < path.size(); ++k) {
            const Frame frame = render_room(camera, path[k]);
            const auto result = slam.process(frame.color, frame.depth);
            EXPECT_EQ(result.tracking, TrackingState::Ok) << k;
            EXPECT_LT((path[k].inverse() * result.T_world_camera).translation().norm(), kMaxError) << k;
        }
    }
    Frame covered = render_room(camera, Isometry3d::Identity());
};

TEST_F(CoveredCamera, HoldsItsPoseUnderAFullMaskAndRecovers) {
    covered.labels = LabelImage(camera.width, camera.height, 1);
    expect_hold_and_recovery();
}

TEST_F(CoveredCamera, HoldsItsPoseWithoutAnyDepthAndRecovers) {
    covered.depth = DepthImage(camera.width, camera.height, 0.0f);
    expect_hold_and_recovery();
}

TEST_F(CoveredCamera, HoldsItsPoseOnBlackFramesAndRecovers) {
    covered.color = ColorImage(camera.width, camera.height);
    covered.depth = DepthImage(camera.width, camera.height, 0.0f);
    expect_hold_and_recovery();
}

TEST_F(CoveredCamera, StartsOnceThereIsSomethingToSee) {
    // no depth at all in the first frames: there is nothing to track against, and later no false success
    Slam slam(camera, test_config(), test_device());
    covered.depth = DepthImage(camera.width, camera.height, 0.0f);
    for (int k = 0; k < 2; ++k) {
        const auto result = slam.process(covered.color, covered.depth);
        EXPECT_EQ(result.surfels, 0u);
        EXPECT_TRUE(result.T_world_camera.matrix().isIdentity());
    }
    EXPECT_TRUE(slam.surfels(false).empty());
}

TEST_F(CoveredCamera, DepthThatIsNotFiniteCountsAsNone) {
    const Frame clean = render_room(camera, Isometry3d::Identity());
    Frame holes = clean, poisoned = clean;
    Random random(5);
    const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                         -std::numeric_limits<float>::infinity(), -1.0f};
    for (std::size_t i = 0; i < clean.depth.size(); ++i) {
        if (!random.chance(0.2)) continue;
        holes.depth[i] = 0;
        poisoned.depth[i] = bad[random.below(4)];
    }
    Slam a(camera, test_config(), test_device()), b(camera, test_config(), test_device());
    for (int k = 0; k < 3; ++k) {
        const auto with_holes = a.process(holes.color, holes.depth),
                   with_poison = b.process(poisoned.color, poisoned.depth);
        EXPECT_EQ(with_holes.T_world_camera.matrix(), with_poison.T_world_camera.matrix());
        EXPECT_EQ(with_holes.surfels, with_poison.surfels);
    }
}

}  // namespace
}  // namespace posefusion::test
