#include <algorithm>
#include <memory>
#include <utility>

#include "engine/core/motion_judge.hpp"
#include "engine/slam/map_piece.hpp"
#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/reference.hpp"
#include "tests/engine/support/synthetic_room.hpp"

// What a judge says to move takes no part in tracking and map, and what the map has of it goes, stable or not.
namespace posefusion::test {
namespace {

/// Says what the test has told it, and keeps count of what it is asked.
class ToldJudge final : public MotionJudge {
public:
    LabelImage movers;     ///< from now on
    LabelImage suspected;  ///< from now on
    int accusations = 0;
    int frames = 0;     ///< ended
    int proposals = 0;  ///< poses that it was asked about
    bool knows_none = true;
    TrackingFit fit_of_last;
    Eigen::Isometry3f T_previous_current = Eigen::Isometry3f::Identity();  ///< of the last frame

    LabelImage begin(const ColorImage&, const DepthImage&, const LabelImage&) override { return {}; }
    LabelImage suspect(const TrackingFit& fit) override {
        fit_of_last = fit;
        return suspected;
    }
    void accuse(const LabelImage&) override { ++accusations; }
    LabelImage find(const Eigen::Isometry3f&) override {
        ++proposals;
        return movers;
    }
    void end(const Eigen::Isometry3f& T) override {
        ++frames;
        knows_none = false;
        T_previous_current = T;
    }
    void restart() override { knows_none = true; }
    [[nodiscard]] ByteArray state() const override {
        StateWriter out;
        out.put(frames);
        return out.take();
    }
    void restore(std::span<const std::byte> state) override { frames = StateReader(state, "the state").get<int>(); }
};

class Movers : public SlamTest {
protected:
    static Ball ball_at(double x) { return {Vector3d(x, 0.1, 1.1), 0.25}; }
    /// Surfels that stand in the room rather than on its surfaces.
    static std::size_t floating(const std::vector<Surfel>& surfels) {
        return static_cast<std::size_t>(std::count_if(surfels.begin(), surfels.end(), [](const Surfel& s) {
            return distance_to_room(s.position.cast<double>()) > 0.06;
        }));
    }
    static LabelImage as_movers(LabelImage labels) {
        for (auto& label : labels) label = label != 0 ? kFirstMoverLabel : 0;
        return labels;
    }
    static LabelImage none() { return {}; }

    const Intrinsics camera = kSmall;
    const std::shared_ptr<ToldJudge> judge = std::make_shared<ToldJudge>();
};

TEST_F(Movers, AJudgeThatFindsNothingChangesNothing) {
    const auto path = path_to(motion({0.06, -0.02, 0.03}, {1, 2, -1}, 5), 8);
    Slam with(camera, test_config(), test_device()), without(camera, test_config(), test_device());
    with.set_motion_judge(judge);
    for (const Isometry3d& T : path) {
        const Frame frame = render_room(camera, T);
        const FrameResult a = with.process(frame.color, frame.depth), b = without.process(frame.color, frame.depth);
        EXPECT_EQ(a.T_world_camera.matrix(), b.T_world_camera.matrix());
        EXPECT_EQ(a.surfels, b.surfels);
        EXPECT_TRUE(a.movers.empty());
    }
    EXPECT_EQ(judge->frames, 8);
    EXPECT_EQ(judge->proposals, 7) << "the first frame has no pose to be judged by";
}

TEST_F(Movers, TheJudgeIsToldHowTheCameraMoved) {
    const auto path = path_to(motion({0.06, -0.02, 0.03}, {1, 2, -1}, 5), 6);
    Slam slam(camera, test_config(), test_device());
    slam.set_motion_judge(judge);
    FrameResult before, now;
    for (const Isometry3d& T : path) {
        const Frame frame = render_room(camera, T);
        before = std::exchange(now, slam.process(frame.color, frame.depth));
    }
    const Isometry3d expected = before.T_world_camera.inverse() * now.T_world_camera;
    EXPECT_LT((expected.matrix() - judge->T_previous_current.cast<double>().matrix()).norm(), 1e-5);
}

TEST_F(Movers, AThingThatWasStillIsRemovedWholeWhenItBeginsToMove) {
    Slam slam(camera, test_config(), test_device());
    slam.set_motion_judge(judge);
    const Frame still = render_room(camera, Isometry3d::Identity(), ball_at(0));
    for (int k = 0; k < 40; ++k) slam.process(still.color, still.depth);
    EXPECT_GT(floating(slam.surfels(true)), 500u) << "the test needs stable surfels of the thing";
    judge->movers = as_movers(still.labels);
    const int asked = judge->proposals;
    const FrameResult result = slam.process(still.color, still.depth);
    EXPECT_EQ(judge->proposals, asked + 2) << "tracked again without the thing, and judged again";
    EXPECT_LE(floating(slam.surfels(false)), 5u);
    EXPECT_EQ(result.movers.size(), still.labels.size());
    EXPECT_GT(result.moving_share, 0.05f);
    // people are not removed in this way: a stable surfel at their depth may be the chair that they sit on
    judge->movers = none();
    for (int k = 0; k < 40; ++k) slam.process(still.color, still.depth);
    slam.process(still.color, still.depth, still.labels);
    EXPECT_GT(floating(slam.surfels(true)), 500u);
}

TEST_F(Movers, AMovingThingDisturbsNeitherPoseNorMap) {
    const auto path = path_to(motion({0.06, -0.02, 0.03}, {1, 2, -1}, 5), 8);
    Slam slam(camera, test_config(), test_device());
    slam.set_motion_judge(judge);
    for (std::size_t k = 0; k < path.size(); ++k) {
        const Frame frame = render_room(camera, path[k], ball_at(-0.4 + 0.1 * static_cast<double>(k)));
        judge->movers = as_movers(frame.labels);
        // the first frame cannot be judged
        const FrameResult result = slam.process(frame.color, frame.depth, k == 0 ? frame.labels : LabelImage());
        const Isometry3d error = path[k].inverse() * result.T_world_camera;
        EXPECT_LT(error.translation().norm(), 11.5e-3) << k;  // as in people_test.cpp
        EXPECT_LT(angle_deg(error), 0.35) << k;
    }
    EXPECT_EQ(floating(slam.surfels(false)), 0u);
}

TEST_F(Movers, ASuspectIsAccusedIfAllElseFitsMuchBetterWithoutIt) {
    Slam with(camera, test_config(), test_device()), without(camera, test_config(), test_device());
    with.set_motion_judge(judge);
    constexpr int kStill = 8;  // frames
    for (int k = 0; k <= kStill; ++k) {
        const Frame frame = render_room(camera, Isometry3d::Identity(), ball_at(k < kStill ? 0 : 0.05));
        if (k == kStill) judge->suspected = frame.labels;
        const FrameResult a = with.process(frame.color, frame.depth), b = without.process(frame.color, frame.depth);
        if (k < kStill) continue;
        EXPECT_LT(a.T_world_camera.translation().norm(), 0.7 * b.T_world_camera.translation().norm())
            << "tracked without it";
    }
    EXPECT_EQ(judge->accusations, 1);
    EXPECT_GT(judge->fit_of_last.icp_scale, 0);
    EXPECT_GT(judge->fit_of_last.photometric_rmse, 0);
}

TEST_F(Movers, ASuspectThatStandsStillChangesNothing) {
    const auto path = path_to(motion({0.06, -0.02, 0.03}, {1, 2, -1}, 5), 8);
    Slam with(camera, test_config(), test_device()), without(camera, test_config(), test_device());
    with.set_motion_judge(judge);
    for (const Isometry3d& T : path) {
        const Frame frame = render_room(camera, T, ball_at(0));
        judge->suspected = frame.labels;
        const FrameResult a = with.process(frame.color, frame.depth), b = without.process(frame.color, frame.depth);
        EXPECT_EQ(a.T_world_camera.matrix(), b.T_world_camera.matrix());
        EXPECT_EQ(a.surfels, b.surfels);
    }
    EXPECT_EQ(judge->accusations, 0);
}

TEST_F(Movers, TheJudgeForgetsWhenTheCameraIsLost) {
    Slam slam(camera, test_config(), test_device());
    slam.set_motion_judge(judge);
    const Frame frame = render_room(camera, Isometry3d::Identity());
    for (int k = 0; k < 3; ++k) slam.process(frame.color, frame.depth);
    EXPECT_FALSE(judge->knows_none);
    slam.process(frame.color, DepthImage(camera.width, camera.height));
    EXPECT_TRUE(judge->knows_none);
}

TEST_F(Movers, WhereLittleFitsTheMapNothingIsKnownToMove) {
    // the camera has got somewhere else, and some of it fits by chance
    Slam slam(camera, test_config(), test_device());
    slam.set_motion_judge(judge);
    const Frame frame = render_room(camera, Isometry3d::Identity());
    for (int k = 0; k < 20; ++k) slam.process(frame.color, frame.depth);  // a map that is kept
    Frame elsewhere = frame;
    for (int v = 0; v < camera.height; ++v)
        for (int u = 0; u < camera.width * 11 / 20; ++u) elsewhere.depth(u, v) *= 0.6f;
    judge->movers = LabelImage(camera.width, camera.height);
    for (int v = 0; v < 20; ++v)
        for (int u = 0; u < 20; ++u) judge->movers(u, v) = kFirstMoverLabel;
    const FrameResult result = slam.process(elsewhere.color, elsewhere.depth);
    EXPECT_EQ(result.tracking, TrackingState::Ok);
    EXPECT_TRUE(result.movers.empty());
    EXPECT_TRUE(judge->knows_none);
    EXPECT_FALSE(slam.process(frame.color, frame.depth).movers.empty()) << "in the room that it knows";
}

TEST_F(Movers, ItsMemoryIsPartOfTheState) {
    Slam slam(camera, test_config(), test_device());
    slam.set_motion_judge(judge);
    const Frame frame = render_room(camera, Isometry3d::Identity());
    for (int k = 0; k < 3; ++k) slam.process(frame.color, frame.depth);
    const AtlasState state = slam.atlas_state();
    slam.process(frame.color, frame.depth);
    EXPECT_EQ(judge->frames, 4);
    slam.restore(state);
    EXPECT_EQ(judge->frames, 3);
}

}  // namespace
}  // namespace posefusion::test
