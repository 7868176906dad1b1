#include "hosts/viewer/draw_pace.hpp"

#include <gtest/gtest.h>

namespace posefusion {
namespace {

constexpr double kSlow = 0.2;  // seconds of the device for a drawn frame

TEST(DrawPace, TheFirstFrameIsDrawnAtOnceAndThenAtMostSixtyASecond) {
    DrawPace pace(false);
    EXPECT_EQ(pace.wait(10), 0);
    pace.drawn(10, 0.001, true);
    pace.changed();
    EXPECT_NEAR(pace.wait(10), 1.0 / 60, 1e-9);
    EXPECT_EQ(pace.wait(10.02), 0);
}

TEST(DrawPace, WithoutNewsItIsDrawnNowAndThenOnly) {
    DrawPace pace(false);
    pace.drawn(10, 0.001, true);
    EXPECT_GT(pace.wait(10.1), 0.3);
    EXPECT_EQ(pace.wait(11), 0);
    pace.touched(10.1);
    EXPECT_EQ(pace.wait(10.1), 0) << "the user is waiting";
}

TEST(DrawPace, OnASharedQueueTrackingGetsMostOfTheDevice) {
    DrawPace pace(true);
    pace.drawn(10, kSlow, true);
    pace.changed();
    EXPECT_GE(pace.wait(10), 5 * kSlow);
    pace.touched(10);
    EXPECT_GE(pace.wait(10), 5 * kSlow) << "whatever the user does";
    pace.drawn(10, kSlow, false);
    pace.changed();
    EXPECT_LT(pace.wait(10), kSlow) << "nobody waits";
}

TEST(DrawPace, OnItsOwnQueueItNeedNotYield) {
    DrawPace pace(false);
    pace.drawn(10, kSlow, true);
    pace.changed();
    EXPECT_LT(pace.wait(10), kSlow);
}

}  // namespace
}  // namespace posefusion
