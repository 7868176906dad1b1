#include "hosts/io/camera_file.hpp"

#include <gtest/gtest.h>

#include <optional>
#include <string>

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

bool has(const std::string& text, const std::string& part) {
    EXPECT_NE(text.find(part), std::string::npos) << text;
    return text.find(part) != std::string::npos;
}

TEST(CameraFile, IsRead) {
    const TempFolder folder;
    const Camera camera = read_camera_file(
        folder.write("camera.yaml", "# Xtion\n" + kGood + "depth_scale: 1000.0\nfps: 30\nk1: 0.1\nk3: -2\nk6: 0.5\n"));
    EXPECT_FLOAT_EQ(camera.intrinsics.fx, 535.4f);
    EXPECT_FLOAT_EQ(camera.intrinsics.fy, 539.2f);
    EXPECT_FLOAT_EQ(camera.intrinsics.cx, 320.1f);
    EXPECT_FLOAT_EQ(camera.intrinsics.cy, 247.6f);
    EXPECT_EQ(camera.intrinsics.width, 640);
    EXPECT_EQ(camera.intrinsics.height, 480);
    EXPECT_FLOAT_EQ(camera.depth_scale, 1000);
    EXPECT_EQ(camera.distortion, (LensCoefficients{0.1f, 0, 0, 0, -2, 0, 0, 0.5f}));
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

TEST(CameraFile, WrittenReadsBackBitForBit) {
    const TempFolder folder;
    Camera camera{{517.30621f, 30.5f, 15.5f, 11.125f, 32, 24}, 1000, {}};
    for (const LensCoefficients& lens :
         {LensCoefficients{}, LensCoefficients{0.2624f, -0.9531f, -0.0054f, 0.0026f, 1.1633f},
          LensCoefficients{0.51f, -2.7f, 0.0006f, -0.00022f, 1.58f, 0.39f, -2.53f, 1.51f}}) {
        camera.distortion = lens;
        camera.deformation.nodes[7] = lens[0] / 100;
        write_camera_file(folder / "c.yaml", camera);
        const Camera read = read_camera_file(folder / "c.yaml");
        EXPECT_EQ(read.intrinsics, camera.intrinsics);
        EXPECT_EQ(read.depth_scale, camera.depth_scale);
        EXPECT_EQ(read.distortion, camera.distortion);
        EXPECT_EQ(read.deformation, camera.deformation);
    }
}

TEST(CameraFile, ADeformationOfDepthHasAllItsNodes) {
    const TempFolder folder;
    EXPECT_TRUE(has(fault(folder, kGood + "depth_deformation: [0.001, 0]\n"), "must hold 20 numbers, not 2"));
    std::string millimetres = "depth_deformation: [5";
    for (std::size_t i = 1; i < DepthDeformation::kNodes; ++i) millimetres += ", 0";
    EXPECT_TRUE(has(fault(folder, kGood + millimetres + "]\n"), "its unit is 1/m"));
}

TEST(CameraFile, KeysThatAreNotKnownOrGivenTwiceAreErrors) {
    const TempFolder folder;
    EXPECT_TRUE(has(fault(folder, kGood + "depthscale: 1000\n"),
                    "'depthscale' (line 7) is not known; the nearest known name is 'depth_scale'"));
    EXPECT_TRUE(has(fault(folder, kGood + "k7: 0.1\n"), "'k7' (line 7) is not known"));
    EXPECT_TRUE(has(fault(folder, kGood + "Fx: 500\n"), "the nearest known name is 'fx'"));
    EXPECT_TRUE(has(fault(folder, kGood + "fx: 500\n"), "'fx' is given twice (lines 1 and 7)"));
}

TEST(CameraFile, WideLensesAreRefused) {
    const TempFolder folder;
    for (const char* model : {"fisheye", "KannalaBrandt8", "equidistant", "omni"})
        EXPECT_TRUE(has(fault(folder, kGood + "model: " + model + "\n"), "undistort the images beforehand")) << model;
    EXPECT_FALSE(read_camera_file(folder.write("camera.yaml", kGood + "model: pinhole\n")).distorted());
}

TEST(CameraFile, ADepthCameraOfItsOwnIsRead) {
    const TempFolder folder;
    const std::string own = kGood +
                            "depth_fx: 365\ndepth_fy: 366\ndepth_cx: 256\ndepth_cy: 212\ndepth_width: 512\n"
                            "depth_height: 424\ndepth_k1: 0.09\ndepth_k3: 0.05\n"
                            "T_color_depth: [0, -1, 0, 0.052, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]\n";
    const CameraDescription description = read_camera_description(folder.write("camera.yaml", own));
    ASSERT_TRUE(description.depth);
    EXPECT_EQ(description.depth->intrinsics, (Intrinsics{365, 366, 256, 212, 512, 424}));
    EXPECT_EQ(description.depth->distortion, (LensCoefficients{0.09f, 0, 0, 0, 0.05f}));
    const Eigen::Vector3f moved = description.depth->T_color_depth * Eigen::Vector3f(1, 0, 2);
    EXPECT_NEAR((moved - Eigen::Vector3f(0.052f, 1, 2)).norm(), 0, 1e-6f);
    EXPECT_TRUE(
        has(message_of<Error>([&] { (void)read_camera_file(folder / "camera.yaml"); }), "gives a depth camera"));

    // The same camera in another size: a pixel block keeps its centre.
    const CameraDescription half =
        read_camera_description(folder.write("camera.yaml", kGood + "depth_width: 320\ndepth_height: 240\n"));
    ASSERT_TRUE(half.depth);
    EXPECT_EQ(half.depth->intrinsics, half.camera.intrinsics.scaled(0.5f));
    EXPECT_TRUE(half.depth->T_color_depth.isApprox(Eigen::Isometry3f::Identity()));
}

TEST(CameraFile, DepthCamerasThatMakeNoSenseAreNamed) {
    const TempFolder folder;
    const std::string size = "depth_width: 320\ndepth_height: 240\n";
    const auto with = [&](const std::string& numbers) { return kGood + size + "T_color_depth: [" + numbers + "]\n"; };
    EXPECT_TRUE(has(fault(folder, kGood + "depth_fx: 365\n"), "'depth_width' is missing"));
    EXPECT_TRUE(has(fault(folder, kGood + size + "depth_fx: 365\n"), "'depth_fy' is missing"));
    EXPECT_TRUE(has(fault(folder, kGood + "depth_k1: 0.1\n"), "'depth_k1' belongs to a depth camera"));
    EXPECT_TRUE(has(fault(folder, with("1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1")), "is no rigid motion: 16 numbers"));
    EXPECT_TRUE(has(fault(folder, with("1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1")), "is no rigid motion"));
    EXPECT_TRUE(has(fault(folder, with("1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1")), "is no rigid motion"));
    EXPECT_TRUE(has(fault(folder, with("1, 0, 0, 52, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1")), "must be in metres"));
}

/// A camera file of another program, and what it says.
struct Foreign {
    const char *name, *content;
    Intrinsics intrinsics;
    LensCoefficients distortion;
    std::optional<float> depth_scale;
};

class ForeignCameraFile : public testing::TestWithParam<Foreign> {};

TEST_P(ForeignCameraFile, IsRead) {
    const TempFolder folder;
    const Foreign& given = GetParam();
    const CameraDescription read = read_camera_description(folder.write(given.name, given.content));
    EXPECT_EQ(read.camera.intrinsics, given.intrinsics);
    EXPECT_EQ(read.camera.distortion, given.distortion);
    EXPECT_EQ(read.says_depth_scale, given.depth_scale.has_value());
    EXPECT_EQ(read.camera.depth_scale, given.depth_scale.value_or(5000));
    EXPECT_FALSE(read.depth);
    EXPECT_FALSE(read.y_up);
}

INSTANTIATE_TEST_SUITE_P(
    All, ForeignCameraFile,
    testing::Values(
        Foreign{"orb_slam2.yaml",
                "%YAML:1.0\n\n#----\n# Camera\nCamera.fx: 517.306408\nCamera.fy: 516.469215\nCamera.cx: 318.643040\n"
                "Camera.cy: 255.313989\n\nCamera.k1: 0.262383\nCamera.k2: -0.953104\nCamera.p1: -0.005358\n"
                "Camera.p2: 0.002628\nCamera.k3: 1.163314\n\nCamera.width: 640\nCamera.height: 480\n"
                "Camera.fps: 30.0\nCamera.bf: 40.0\nCamera.RGB: 1\nThDepth: 40.0\nDepthMapFactor: 5000.0\n"
                "ORBextractor.nFeatures: 1000\nViewer.KeyFrameSize: 0.05\n",
                {517.306408f, 516.469215f, 318.643040f, 255.313989f, 640, 480},
                {0.262383f, -0.953104f, -0.005358f, 0.002628f, 1.163314f},
                5000},
        Foreign{"orb_slam3.yaml",
                "%YAML:1.0\n---\nFile.version: \"1.0\"\nCamera.type: \"PinHole\"\nCamera1.fx: 535.4\n"
                "Camera1.fy: 539.2\nCamera1.cx: 320.1\nCamera1.cy: 247.6\nCamera1.k1: 0.0\nCamera1.k2: 0.0\n"
                "Camera1.p1: 0.0\nCamera1.p2: 0.0\nCamera.width: 640\nCamera.height: 480\nCamera.newWidth: 600\n"
                "Camera.fps: 30\nCamera.RGB: 1\nStereo.ThDepth: 40.0\nStereo.b: 0.0747\n"
                "RGBD.DepthMapFactor: 1000.0\nORBextractor.nLevels: 8\n",
                {535.4f, 539.2f, 320.1f, 247.6f, 640, 480},
                {},
                1000},
        Foreign{"opencv.yml",
                "%YAML:1.0\n---\ncalibration_time: \"Tue 5 May\"\nnframes: 20\nimage_width: 640\nimage_height: 480\n"
                "board_width: 9\nboard_height: 6\nsquare_size: 2.5e-02\nflags: 0\n"
                "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
                "   data: [ 5.1730000000000001e+02, 0., 3.1860000000000002e+02, 0.,\n"
                "       5.1650000000000000e+02, 2.5530000000000001e+02, 0., 0., 1. ]\n"
                "distortion_coefficients: !!opencv-matrix\n   rows: 8\n   cols: 1\n   dt: d\n"
                "   data: [ 0.5, -2.5, 1e-3, -2e-3, 1.5, 0.375, -2.25, 1.25 ]\n"
                "avg_reprojection_error: 0.2\n",
                {517.3f, 516.5f, 318.6f, 255.3f, 640, 480},
                {0.5f, -2.5f, 1e-3f, -2e-3f, 1.5f, 0.375f, -2.25f, 1.25f},
                std::nullopt},
        Foreign{"ros_camera_info.yaml",
                "image_width: 640\nimage_height: 480\ncamera_name: rgb_PS1080\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
                "  data: [525.5, 0, 319.5, 0, 526.5, 239.5, 0, 0, 1]\ndistortion_model: plumb_bob\n"
                "distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0.1, -0.2, 0.001, 0.002, 0]\n"
                "rectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1, 0, 0, 0, 1, 0, 0, 0, 1]\n"
                "projection_matrix:\n  rows: 3\n  cols: 4\n  data: [530, 0, 320, 0, 0, 531, 240, 0, 0, 0, 1, 0]\n",
                {525.5f, 526.5f, 319.5f, 239.5f, 640, 480},
                {0.1f, -0.2f, 0.001f, 0.002f},
                std::nullopt},
        Foreign{"ros_message.yaml",
                "header:\n  seq: 1\n  frame_id: camera\nheight: 480\nwidth: 640\ndistortion_model: equidistant\n"
                "D: [0.0, 0.0, 0.0, 0.0]\nK: [525.5, 0.0, 319.5, 0.0, 526.5, 239.5, 0.0, 0.0, 1.0]\n"
                "R: [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]\nbinning_x: 0\nroi:\n  x_offset: 0\n",
                {525.5f, 526.5f, 319.5f, 239.5f, 640, 480},
                {},
                std::nullopt},
        Foreign{"open3d.json",
                "{\n \"width\": 640,\n \"height\": 480,\n \"intrinsic_matrix\": [525.5, 0, 0, 0, 526.5, 0, 319.5, "
                "239.5, 1]\n}\n",
                {525.5f, 526.5f, 319.5f, 239.5f, 640, 480},
                {},
                std::nullopt},
        Foreign{"open3d_parameters.json",
                "{\"class_name\": \"PinholeCameraParameters\", \"version_major\": 1, \"version_minor\": 0,\n"
                " \"extrinsic\": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1],\n \"intrinsic\": {\n"
                " \"width\": 640, \"height\": 480,\n \"intrinsic_matrix\": [525.5, 0, 0, 0, 526.5, 0, 319.5, 239.5, "
                "1]\n}}\n",
                {525.5f, 526.5f, 319.5f, 239.5f, 640, 480},
                {},
                std::nullopt},
        Foreign{"cam_params.json",
                "{\"camera\": {\"w\": 1200, \"h\": 680, \"fx\": 600.0, \"fy\": 600.0, \"cx\": 599.5, \"cy\": 339.5, "
                "\"scale\": 6553.5}}",
                {600, 600, 599.5f, 339.5f, 1200, 680},
                {},
                6553.5f},
        Foreign{"calibration.txt",
                "726.28741455078125 726.28741455078125 354.6496887207 186.46566772461\n",
                {726.28741455078125f, 726.28741455078125f, 354.6496887207f, 186.46566772461f, 0, 0},
                {},
                std::nullopt},
        Foreign{"intrinsics.txt",
                "570.342205 0 320\n0 570.342205 240\n0 0 1\n",
                {570.342205f, 570.342205f, 320, 240, 0, 0},
                {},
                std::nullopt},
        Foreign{"intrinsic_color.txt",
                "1169.621094 0.000000 646.295044 0.000000\n0.000000 1167.105103 489.927032 0.000000\n"
                "0.000000 0.000000 1.000000 0.000000\n0.000000 0.000000 0.000000 1.000000\n",
                {1169.621094f, 1167.105103f, 646.295044f, 489.927032f, 0, 0},
                {},
                std::nullopt}),
    [](const auto& test) { return std::string(test.param.name).substr(0, std::string(test.param.name).find('.')); });

TEST(ForeignCameraFile, InUtf16IsReadToo) {
    const TempFolder folder;
    std::string wide = "\xFF\xFE";
    for (const char c : kGood) wide += {c, '\0'};
    EXPECT_FLOAT_EQ(read_camera_file(folder.write("camera.yaml", wide)).intrinsics.fx, 535.4f);
}

/// ICL-NUIM's fy: v = fy * Y / Z + cy with Y up is v = -fy * y / z + cy with y down.
TEST(ForeignCameraFile, ANegativeFyMeansThatYPointsUp) {
    const TempFolder folder;
    const CameraDescription icl =
        read_camera_description(folder.write("icl.yaml",
                                             "Camera.fx: 481.2\nCamera.fy: -480.0\nCamera.cx: 319.5\nCamera.cy: 239.5\n"
                                             "Camera.p1: 0.01\nCamera.p2: 0.02\n"));
    EXPECT_TRUE(icl.y_up);
    EXPECT_EQ(icl.camera.intrinsics, (Intrinsics{481.2f, 480, 319.5f, 239.5f, 0, 0}));
    const PlanePoint up = distort({0.3f, 0.2f}, {0, 0, 0.01f, 0.02f}),
                     down = distort({0.3f, -0.2f}, icl.camera.distortion);
    EXPECT_FLOAT_EQ(down.x, up.x);
    EXPECT_FLOAT_EQ(down.y, -up.y);
}

TEST(ForeignCameraFile, FaultsAreNamed) {
    const TempFolder folder;
    const std::string orb = "Camera.fx: 5\nCamera.fy: 5\nCamera.cx: 5\nCamera.cy: 5\n";
    const std::string ros =
        "image_width: 640\nimage_height: 480\ncamera_matrix: {rows: 3, cols: 3, data: [5, 0, 3, 0, 5, "
        "2, 0, 0, 1]}\n";
    EXPECT_TRUE(has(fault(folder, orb + "Camera.kl: 1\n"), "the nearest known name is 'Camera.k1'"));
    EXPECT_TRUE(has(fault(folder, orb + "Camera.type: \"KannalaBrandt8\"\n"), "undistort the images beforehand"));
    EXPECT_TRUE(has(fault(folder, orb + "Camera.width: 640\n"), "'Camera.height' is missing"));
    EXPECT_TRUE(has(fault(folder, orb + "DepthMapFactor: 5000\nRGBD.DepthMapFactor: 1000\n"), "mean the same"));
    EXPECT_TRUE(has(fault(folder, orb), "does not say how large the images are"));
    EXPECT_TRUE(has(fault(folder, "Camera1.fx: 5\n"), "'Camera1.fy' is missing"));
    EXPECT_TRUE(has(fault(folder, ros + "distortion_model: equidistant\nD: [0.1, 0, 0, 0]\n"), "equidistant"));
    EXPECT_TRUE(has(fault(folder, ros + "D: [0.1, 0, 0]\n"), "must hold 4, 5 or 8 coefficients"));
    EXPECT_TRUE(has(fault(folder, ros + "distorsion_model: plumb_bob\n"), "nearest known name is 'distortion_model'"));
    EXPECT_TRUE(has(fault(folder, "camera_matrix: {data: [5, 0, 0, 0, 5, 0, 3, 2, 1]}\n"), "transpose it"));
    EXPECT_TRUE(has(fault(folder, "camera_matrix: {rows: 3, cols: 3}\n"), "'camera_matrix' is missing or no list"));
    EXPECT_TRUE(has(fault(folder, "camera_matrix: {data: {data: [5]}}\n"), "'camera_matrix' is missing or no list"));
    EXPECT_TRUE(has(fault(folder, "{\"intrinsic_matrix\": [5, 0, 3, 0, 5, 2, 0, 0, 1]}"), "transpose it"));
    EXPECT_TRUE(has(fault(folder, "<?xml version=\"1.0\"?>\n"), "save the calibration as YAML"));
    EXPECT_TRUE(has(fault(folder, "1 2 3 4 5\n"), "holds 5 numbers"));
    EXPECT_TRUE(has(fault(folder, "-5 5 3 2\n"), "must be positive"));
    EXPECT_TRUE(has(fault(folder, std::string("15 a\n0  \0\n  \n0\n", 14)), "is not YAML")) << "in one line";
}

}  // namespace
}  // namespace posefusion
