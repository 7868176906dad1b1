#include "hosts/evaluate/trajectory_pair.hpp"

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

using test::message_of;

class Pair : public testing::Test {
protected:
    const test::TempFolder folder;
    const std::filesystem::path tum = folder.write("tum.txt", "5 0 0 0 0 0 0 1\n6 0 0 0 0 0 0 1\n7.5 0 0 0 0 0 0 1\n"),
                                kitti = folder.write("kitti.txt",
                                                     "1 0 0 1 0 1 0 0 0 0 1 0\n"
                                                     "1 0 0 nan 0 1 0 0 0 0 1 0\n"
                                                     "1 0 0 3 0 1 0 0 0 0 1 0\n");
};

TEST_F(Pair, WithoutStampsTakesThoseOfTheOtherFilePoseByPose) {
    for (const bool estimate_timed : {false, true}) {
        const TrajectoryPair pair =
            estimate_timed ? read_trajectory_pair(kitti, tum) : read_trajectory_pair(tum, kitti);
        const Trajectory& poses = estimate_timed ? pair.groundtruth.poses : pair.estimate.poses;
        EXPECT_TRUE(pair.timed);
        ASSERT_EQ(poses.size(), 2u);
        EXPECT_EQ(poses[0].stamp, std::chrono::seconds(5));
        EXPECT_EQ(poses[1].stamp, std::chrono::milliseconds(7500)) << "the one between them was lost";
        EXPECT_EQ(poses[1].T_world_camera.translation().x(), 3);
    }
}

TEST_F(Pair, WithoutAnyStampsIsPairedByNumber) {
    const TrajectoryPair pair = read_trajectory_pair(kitti, kitti);
    EXPECT_FALSE(pair.timed);
    EXPECT_EQ(pair.estimate.poses[1].stamp, std::chrono::seconds(2));
}

TEST_F(Pair, OfUnequalNumbersIsRefused) {
    const auto longer = folder.write("longer.txt", test::read_all(kitti) + "1 0 0 1 0 1 0 0 0 0 1 0\n");
    for (const auto& other : {tum, kitti})
        EXPECT_NE(message_of<Error>([&] {
                      (void)read_trajectory_pair(other, longer);
                  }).find("equally many poses: the ground truth has 3, the estimate 4"),
                  std::string::npos);
}

}  // namespace
}  // namespace posefusion
