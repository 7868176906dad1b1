#include "hosts/viewer/draw_pace.hpp"

#include <gtest/gtest.h>

namespace posefusion {
namespace {

constexpr double kSlow = 0.2;  // seconds of the device for a drawn frame

TEST(DrawPace, TheFirstFrameIsDrawnAtOnceAndThenAtMostSixtyASecond) {
    DrawPace pace(false);
    EXPECT_EQ(pace.wait(10), 0);
    pace.drawn(10, true);
    pace.finished(0.001, 100);
    pace.changed();
    EXPECT_NEAR(pace.wait(10), 1.0 / 60, 1e-9);
    EXPECT_EQ(pace.wait(10.02), 0);
}

TEST(DrawPace, WithoutNewsItIsDrawnNowAndThenOnly) {
    DrawPace pace(false);
    pace.drawn(10, true);
    EXPECT_GT(pace.wait(10.1), 0.3);
    EXPECT_EQ(pace.wait(11), 0);
    pace.touched(10.1);
    EXPECT_EQ(pace.wait(10.1), 0) << "the user is waiting";
}

TEST(DrawPace, OnASharedQueueTrackingGetsMostOfTheDevice) {
    DrawPace pace(true);
    pace.drawn(10, true);
    pace.finished(kSlow, 100);
    pace.changed();
    EXPECT_GE(pace.wait(10), 5 * kSlow);
    pace.touched(10);
    EXPECT_GE(pace.wait(10), 5 * kSlow) << "whatever the user does";
    pace.drawn(10, false);
    pace.finished(kSlow, 100);
    pace.changed();
    EXPECT_LT(pace.wait(10), kSlow) << "nobody waits";
}

TEST(DrawPace, OnItsOwnQueueItNeedNotYield) {
    DrawPace pace(false);
    pace.drawn(10, true);
    pace.finished(kSlow, 100);
    pace.changed();
    EXPECT_LT(pace.wait(10), kSlow);
    EXPECT_EQ(pace.stride(1'000'000, true), 1u);
}

TEST(DrawPace, FewerSurfelsAreDrawnWhereTrackingWaitsForThemAndAllWhereNot) {
    DrawPace pace(true);
    EXPECT_EQ(pace.stride(100'000, true), 1u) << "nothing is known yet";
    pace.drawn(10, true);
    pace.finished(0.1, 100'000);
    const std::uint32_t stride = pace.stride(100'000, true);
    EXPECT_GT(stride, 4u);
    EXPECT_LT(stride, 10u);
    pace.finished(0.1 / stride, 100'000 / stride);
    EXPECT_NEAR(pace.stride(100'000, true), stride, 1) << "settles";
    EXPECT_EQ(pace.stride(100'000, false), 1u);
    EXPECT_LE(pace.stride(4'000'000'000u, true), 16u) << "never a mere sprinkle";
    EXPECT_EQ(pace.stride(0, true), 1u);
}

}  // namespace
}  // namespace posefusion
