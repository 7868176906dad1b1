#include "hosts/io/camera_file.hpp"

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

using test::message_of;
using test::TempFolder;

const std::string kGood = "fx: 535.4\nfy: 539.2\ncx: 320.1\ncy: 247.6\nwidth: 640\nheight: 480\n";

std::string fault(const TempFolder& folder, const std::string& content) {
    const auto file = folder.write("camera.yaml", content);
    const std::string message = message_of<Error>([&] { (void)read_camera_file(file); });
    EXPECT_NE(message.find(file.string()), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    return message;
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
}

TEST(CameraFile, IsRead) {
    const TempFolder folder;
    const Camera camera = read_camera_file(
        folder.write("camera.yaml", "# Xtion\n" + kGood + "depth_scale: 1000.0\nfps: 30\nk1: 0.1\nk3: -2\n"));
    EXPECT_FLOAT_EQ(camera.intrinsics.fx, 535.4f);
    EXPECT_FLOAT_EQ(camera.intrinsics.fy, 539.2f);
    EXPECT_FLOAT_EQ(camera.intrinsics.cx, 320.1f);
    EXPECT_FLOAT_EQ(camera.intrinsics.cy, 247.6f);
    EXPECT_EQ(camera.intrinsics.width, 640);
    EXPECT_EQ(camera.intrinsics.height, 480);
    EXPECT_FLOAT_EQ(camera.depth_scale, 1000);
    EXPECT_EQ(camera.distortion, (std::array<float, 5>{0.1f, 0, 0, 0, -2}));
    EXPECT_TRUE(camera.distorted());
}

TEST(CameraFile, ScaleAndDistortionHaveDefaults) {
    const TempFolder folder;
    const Camera camera = read_camera_file(folder.write("camera.yaml", replaced(kGood, "\n", "\r\n")));
    EXPECT_FLOAT_EQ(camera.depth_scale, 5000);
    EXPECT_FALSE(camera.distorted());
}

TEST(CameraFile, FaultsAreNamed) {
    const TempFolder folder;
    EXPECT_NE(fault(folder, replaced(kGood, "fy: 539.2\n", "")).find("'fy' is missing"), std::string::npos);
    EXPECT_NE(fault(folder, replaced(kGood, "535.4", "-535.4")).find("'fx' must be positive"), std::string::npos);
    EXPECT_NE(fault(folder, replaced(kGood, "535.4", "0")).find("'fx' must be positive"), std::string::npos);
    EXPECT_NE(fault(folder, replaced(kGood, "535.4", ".nan")).find("'fx' is not a number"), std::string::npos);
    EXPECT_NE(fault(folder, replaced(kGood, "320.1", "[1, 2]")).find("'cx' is not a number"), std::string::npos);
    EXPECT_NE(fault(folder, replaced(kGood, "640", "640.5")).find("'width'"), std::string::npos);
    EXPECT_NE(fault(folder, replaced(kGood, "640", "100000")).find("'width'"), std::string::npos);
    EXPECT_NE(fault(folder, kGood + "depth_scale: 0\n").find("'depth_scale' must be positive"), std::string::npos);
    EXPECT_NE(fault(folder, "fx: [1,\n").find("is not YAML"), std::string::npos);
    EXPECT_NE(fault(folder, "just text").find("name: value"), std::string::npos);
    EXPECT_NE(fault(folder, "").find("name: value"), std::string::npos);
    EXPECT_NE(message_of<Error>([&] { (void)read_camera_file(folder / "none.yaml"); }).find("not found"),
              std::string::npos);
    EXPECT_THROW((void)read_camera_file(folder.path()), Error);
}

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

}  // namespace
}  // namespace posefusion
