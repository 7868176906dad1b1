#include "hosts/io/known_cameras.hpp"

#include <gtest/gtest.h>

namespace posefusion {
namespace {

TEST(TumCamera, IsKnownByFolderName) {
    EXPECT_FLOAT_EQ(tum_camera("rgbd_dataset_freiburg1_desk")->intrinsics.fx, 517.3f);
    EXPECT_FLOAT_EQ(tum_camera("rgbd_dataset_freiburg2_xyz")->intrinsics.fx, 520.9f);
    EXPECT_FLOAT_EQ(tum_camera("rgbd_dataset_Freiburg3_walking_xyz")->intrinsics.fx, 535.4f);
    EXPECT_FLOAT_EQ(tum_camera("fr3_sitting_static")->intrinsics.cy, 247.6f);
    EXPECT_FLOAT_EQ(tum_camera("my-FR1-desk")->depth_scale, 5000);
    EXPECT_TRUE(tum_camera("fr2")->distorted());
    EXPECT_FALSE(tum_camera("fr3")->distorted());
}

TEST(TumCamera, OtherNamesAreNotTakenForIt) {
    for (const char* name : {"office", "fr10_desk", "fr4", "afr1ca", "freiburg", "", "frame1"})
        EXPECT_FALSE(tum_camera(name)) << name;
}

TEST(KnownCamera, IsToldByTheName) {
    EXPECT_FLOAT_EQ(known_camera("living_room_traj2_frei_png")->intrinsics.fx, 481.2f);
    EXPECT_FLOAT_EQ(known_camera("ICL_lr_kt2")->intrinsics.fx, 481.2f);
    EXPECT_FLOAT_EQ(known_camera("rgbd_dataset_freiburg1_xyz")->intrinsics.fx, 517.3f);
    EXPECT_FLOAT_EQ(known_camera("rgbd_bonn_balloon_tracking")->intrinsics.cy, 237.756098f);
    EXPECT_FLOAT_EQ(known_camera("rgbd_bonn_crowd2")->distortion[1], -0.099343f);
    for (const char* name : {"bicycle", "icleaning", "room"}) EXPECT_FALSE(known_camera(name)) << name;
}

}  // namespace
}  // namespace posefusion
