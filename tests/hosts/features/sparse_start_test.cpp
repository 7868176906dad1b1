// The motion of the camera from images: since the previous frame and since the reference frame.
#include "hosts/features/sparse_start.hpp"

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "tests/engine/support/reference.hpp"
#include "tests/engine/support/synthetic_room.hpp"

namespace posefusion {
namespace {

using test::motion;

const Intrinsics kCamera{525, 525, 319.5f, 239.5f, 640, 480};
constexpr double kMaxError = 0.01;  // metres
constexpr double kMaxAngle = 0.4;   // degrees

SparseStart make_start() { return {kCamera, DepthNoise{}, FeatureConfig{}}; }

std::vector<StartPose> find(SparseStart& start, const Eigen::Isometry3d& T_world_camera,
                            const std::optional<test::Ball>& ball = {}) {
    const test::Frame frame = test::render_room(kCamera, T_world_camera, ball);
    return start.find(frame.color, frame.depth, frame.labels);
}

void expect_near(const Eigen::Isometry3d& found, const Eigen::Isometry3d& truth, double max_error = kMaxError) {
    const Eigen::Isometry3d error = truth.inverse() * found;
    EXPECT_LT(error.translation().norm(), max_error);
    EXPECT_LT(test::angle_deg(error), kMaxAngle);
}

const Eigen::Isometry3d kPath[] = {Eigen::Isometry3d::Identity(), motion({0.1, 0, 0.05}, {0, 1, 0}, 4),
                                   motion({0.2, -0.05, 0.1}, {0, 1, 0.1}, 9),
                                   motion({0.25, -0.1, 0}, {0.1, 1, 0.1}, 12)};

TEST(SparseStart, FindsTheMotionSinceThePreviousFrameAndTheReference) {
    SparseStart start = make_start();
    EXPECT_TRUE(find(start, kPath[0]).empty()) << "there is no earlier frame";
    for (std::uint32_t k = 1; k < std::size(kPath); ++k) {
        const std::vector<StartPose> starts = find(start, kPath[k]);
        ASSERT_EQ(starts.size(), k == 1 ? 1u : 2u) << k;
        EXPECT_EQ(starts[0].age, 1u);
        expect_near(starts[0].T_earlier_current, kPath[k - 1].inverse() * kPath[k]);
        EXPECT_GE(starts[0].inliers, static_cast<std::uint32_t>(FeatureConfig::kMinInliers));
        if (k == 1) continue;
        EXPECT_GT(starts[1].age, 1u) << "that is the previous frame";
        expect_near(starts[1].T_earlier_current, kPath[k - starts[1].age].inverse() * kPath[k]);
    }
}

TEST(SparseStart, KeepsTheReferenceWhileABadFramePasses) {
    SparseStart start = make_start();
    (void)find(start, kPath[0]);
    (void)find(start, kPath[1]);
    EXPECT_TRUE(start.find(ColorImage(640, 480), DepthImage(640, 480), {}).empty()) << "nothing to see";
    const std::vector<StartPose> starts = find(start, kPath[2]);
    ASSERT_EQ(starts.size(), 1u);
    EXPECT_GT(starts[0].age, 1u);
    expect_near(starts[0].T_earlier_current, kPath[3 - starts[0].age].inverse() * kPath[2]);
}

TEST(SparseStart, TakesANewReferenceWhenTheViewHasChanged) {
    SparseStart start = make_start();
    std::uint32_t oldest = 0;
    for (int k = 0; k <= 8; ++k) {
        const auto starts = find(start, motion({0, 0, 0}, {0, 1, 0}, 8 * k));
        for (const StartPose& pose : starts) oldest = pose.age;
    }
    EXPECT_LT(oldest, 8u);
}

/// Turns away from the first view and is covered. @return frames since the first
std::uint32_t turn_away_and_cover(SparseStart& start) {
    std::uint32_t frames = 0;
    for (; frames < 6; ++frames) (void)find(start, motion({0, 0, 0}, {0, 1, 0}, 8.0 * frames));
    for (; frames < 8; ++frames) (void)start.find(ColorImage(640, 480), DepthImage(640, 480), {});
    return frames;
}

TEST(SparseStart, RecognisesAnEarlierPlaceAfterABreak) {
    SparseStart start = make_start();
    const std::uint32_t frames = turn_away_and_cover(start);
    const Eigen::Isometry3d place = motion({0.08, -0.03, 0.1}, {0.2, 1, 0}, 5);
    for (std::uint32_t k = 0; k < 3; ++k) {
        std::vector<StartPose> starts = find(start, place);
        std::erase_if(starts, [](const StartPose& pose) { return pose.age == 1; });
        ASSERT_FALSE(starts.empty()) << k;
        for (const StartPose& pose : starts) {
            const std::uint32_t earlier = frames + k - pose.age;
            if (earlier >= frames) continue;  // since the break
            expect_near(pose.T_earlier_current, motion({0, 0, 0}, {0, 1, 0}, -8.0 * earlier) * place,
                        2 * kMaxError);  // seen from farther away than from frame to frame
        }
    }
}

TEST(SparseStart, RecognisesNoPlaceWhereItHasNeverBeen) {
    SparseStart start = make_start();
    (void)turn_away_and_cover(start);
    EXPECT_TRUE(find(start, motion({0, 0, 0}, {0, 1, 0}, 190)).empty());
}

TEST(SparseStart, ContinuesInTheMiddleOfASearch) {
    SparseStart whole = make_start(), restored = make_start();
    (void)turn_away_and_cover(whole);
    (void)find(whole, motion({0, 0, 0}, {0, 1, 0}, 190));
    restored.restore(whole.state());
    const Eigen::Isometry3d place = motion({0.05, 0, 0.05}, {0, 1, 0}, 3);
    const auto expected = find(whole, place), actual = find(restored, place);
    ASSERT_FALSE(expected.empty());
    ASSERT_EQ(actual.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i)
        EXPECT_EQ(actual[i].T_earlier_current.matrix(), expected[i].T_earlier_current.matrix());
    EXPECT_EQ(restored.state(), whole.state());
}

TEST(SparseStart, DoesNotFollowPeople) {
    SparseStart start = make_start();
    (void)find(start, kPath[0], test::Ball{{-0.1, 0, 1.2}, 0.3});
    const auto starts = find(start, kPath[1], test::Ball{{0.3, 0, 1.2}, 0.3});
    ASSERT_EQ(starts.size(), 1u);
    expect_near(starts[0].T_earlier_current, kPath[1]);
}

TEST(SparseStart, ContinuesFromItsState) {
    SparseStart whole = make_start(), first = make_start(), second = make_start();
    for (const auto& pose : {kPath[0], kPath[1]}) (void)find(whole, pose), (void)find(first, pose);
    second.restore(first.state());
    EXPECT_EQ(second.state(), first.state());
    for (const auto& pose : {kPath[2], kPath[3]}) {
        const auto expected = find(whole, pose), actual = find(second, pose);
        ASSERT_EQ(actual.size(), expected.size());
        for (std::size_t i = 0; i < expected.size(); ++i) {
            EXPECT_EQ(actual[i].age, expected[i].age);
            EXPECT_EQ(actual[i].T_earlier_current.matrix(), expected[i].T_earlier_current.matrix());
        }
    }
    EXPECT_EQ(second.state(), whole.state());
}

TEST(SparseStart, RefusesAStateThatIsNone) {
    SparseStart start = make_start();
    (void)find(start, kPath[0]);
    ByteArray bytes = start.state();
    bytes.pop_back();
    EXPECT_THROW(make_start().restore(bytes), Error);
    EXPECT_THROW(make_start().restore(ByteArray(7)), Error);
}

}  // namespace
}  // namespace posefusion
