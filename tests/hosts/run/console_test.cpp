#include "hosts/run/console.hpp"

#include <gtest/gtest.h>

namespace posefusion {
namespace {

TEST(Console, ProgressSaysHowFarHowFastAndHowLong) {
    EXPECT_EQ(progress_text({120, 170, 3.4, map_text(412'345, 2)}),
              "frame 120/170   3.4 fps   ETA 0:15   412 k surfels   2 people");
    EXPECT_EQ(progress_text({1, 170, 0, map_text(99, 1)}), "frame 1/170   99 surfels   1 person");
    EXPECT_EQ(progress_text({1, 20001, 2, ""}), "frame 1/20001   2.0 fps   ETA 2:46:40");
}

TEST(Console, TheBarFitsTheTerminal) {
    const Progress half{50, 100, 3, "400 k surfels"};
    EXPECT_EQ(progress_bar(half, 120), "[############            ] frame 50/100   3.0 fps   ETA 0:17   400 k surfels");
    EXPECT_EQ(progress_bar(half, 60), progress_text(half));
    EXPECT_EQ(progress_bar(half, 20), progress_text(half).substr(0, 19));
    EXPECT_EQ(progress_bar(half, 0), "");
}

TEST(Console, TheFirstFrameDoesNotCountForTheRate) {
    FrameRate rate;
    EXPECT_EQ(rate.after(1), 0);
    EXPECT_GT(rate.after(2), 0);
}

}  // namespace
}  // namespace posefusion
