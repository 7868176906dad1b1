// Tracking begins at a start pose where its own start would miss, and only there.
#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/reference.hpp"
#include "tests/engine/support/synthetic_room.hpp"

namespace posefusion::test {
namespace {

constexpr double kMaxError = 5e-3;  // metres

class StartPoseTest : public SlamTest {
protected:
    const Isometry3d big = motion({0.16, -0.06, 0.05}, {0.2, 1, 0.1}, -12);
    const Isometry3d small = motion({0.01, 0, 0.005}, {0, 1, 0}, 0.5);
    /// What features are wrong by.
    const Isometry3d noise = motion({0.008, -0.004, 0.006}, {1, 0, 1}, 0.4);

    /// The second frame of a camera that makes one step.
    [[nodiscard]] static FrameResult after_step(const Isometry3d& step, std::span<const StartPose> starts) {
        Slam slam(kSmall, test_config(), test_device());
        const Frame first = render_room(kSmall, Isometry3d::Identity()), second = render_room(kSmall, step);
        (void)slam.process(first.color, first.depth);
        return slam.process(second.color, second.depth, {}, {}, starts);
    }
    [[nodiscard]] static StartPose start_at(const Isometry3d& T_earlier_current, std::uint32_t age = 1) {
        StartPose start;
        start.age = age;
        start.T_earlier_current = T_earlier_current;
        start.inliers = 100;
        return start;
    }
    static double error(const FrameResult& result, const Isometry3d& truth) {
        return (truth.inverse() * result.T_world_camera).translation().norm();
    }
};

TEST_F(StartPoseTest, FindsABigStep) {
    const FrameResult alone = after_step(big, {});
    EXPECT_TRUE(alone.tracking != TrackingState::Ok || error(alone, big) > 0.05) << "the step is not big";
    const StartPose start = start_at(big * noise);
    const FrameResult result = after_step(big, {&start, 1});
    EXPECT_EQ(result.tracking, TrackingState::Ok);
    EXPECT_TRUE(result.start_used);
    EXPECT_EQ(result.start_inliers, 100u);
    EXPECT_LT(error(result, big), kMaxError);
}

TEST_F(StartPoseTest, ChangesNothingWhereTrackingStartsWellByItself) {
    const StartPose start = start_at(small * motion({0.002, 0, 0}, {0, 1, 0}, 0.1));
    const FrameResult alone = after_step(small, {}), result = after_step(small, {&start, 1});
    EXPECT_FALSE(result.start_used);
    EXPECT_EQ(result.T_world_camera.matrix(), alone.T_world_camera.matrix());
}

TEST_F(StartPoseTest, AWrongOneDoesNoHarm) {
    for (const Isometry3d& wrong : {big, motion({-0.2, 0, 0}, {0, 1, 0}, 10), motion({0, 0, 0.25}, {0, 0, 1}, 20)}) {
        const StartPose start = start_at(wrong);
        const FrameResult result = after_step(small, {&start, 1});
        EXPECT_FALSE(result.start_used);
        EXPECT_LT(error(result, small), kMaxError);
    }
}

TEST_F(StartPoseTest, OfAFrameThatIsNotKnownIsPassedOver) {
    const StartPose starts[] = {start_at(motion({-0.2, 0, 0}, {0, 1, 0}, 10), 2), start_at(big * noise)};
    const FrameResult result = after_step(big, starts);
    EXPECT_TRUE(result.start_used) << "there was one frame before";
    EXPECT_LT(error(result, big), kMaxError);
}

}  // namespace
}  // namespace posefusion::test
