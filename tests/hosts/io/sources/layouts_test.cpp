// Folders as data sets and programs lay them out, read as they come.
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "hosts/io/known_cameras.hpp"
#include "tests/hosts/io/sources/frames.hpp"

namespace posefusion::test {
namespace {

/// A matrix as text, row by row.
std::string matrix_text(const Eigen::Matrix4d& m) {
    std::ostringstream text;
    text.precision(12);
    text << m << '\n';
    return text.str();
}

class Layout : public testing::Test {
protected:
    void write_color(const std::string& name, int width = kWidth, int height = kHeight) const {
        std::filesystem::create_directories((folder / name).parent_path());
        const ColorImage image(width, height, {10, 120, 200});
        if (name.ends_with(".png"))
            write_png(folder / name, image);
        else
            write_jpeg(folder / name, image, 95);
    }
    void write_depth(const std::string& name, std::uint16_t value, int width = kWidth, int height = kHeight) const {
        std::filesystem::create_directories((folder / name).parent_path());
        write_raw_depth(folder / name, RawDepth(width, height, value));
    }
    std::unique_ptr<FrameSource> open(const SourceOptions& options = {}) const {
        return open_source(folder.path(), options);
    }
    std::string fault() const { return open_fault(folder.path()); }
    static float metres(const FrameSource& source, std::size_t frame = 0) {
        const DepthImage depth = to_metres(source.read(frame).depth, source.camera().depth_scale);
        return depth(depth.width() / 2, depth.height() / 2);
    }
    static std::string all(const std::vector<std::string>& warnings) {
        std::string text;
        for (const std::string& warning : warnings) text += warning + "\n";
        return text;
    }
    TempFolder folder;
};

const Eigen::Isometry3d kPose = Eigen::Translation3d(0.5, -1, 2) * Eigen::AngleAxisd(0.7, Eigen::Vector3d::UnitY());

/// color/0.jpg, depth/0.png, pose/0.txt, intrinsic/: two cameras, colour in a larger image, depth in millimetres.
TEST_F(Layout, ScanNet) {
    for (const int i : {0, 1, 2, 10}) {
        write_color("color/" + std::to_string(i) + ".jpg", 64, 48);
        write_depth("depth/" + std::to_string(i) + ".png", 2000);
        folder.write("pose/" + std::to_string(i) + ".txt", matrix_text(kPose.matrix()));
    }
    folder.write("pose/1.txt", "-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n");
    folder.write("intrinsic/intrinsic_color.txt", "60 0 31.5 0\n0 60 23.5 0\n0 0 1 0\n0 0 0 1\n");
    folder.write("intrinsic/intrinsic_depth.txt", "20 0 15.5 0\n0 20 11.5 0\n0 0 1 0\n0 0 0 1\n");
    Eigen::Isometry3d extrinsic = Eigen::Isometry3d::Identity();
    folder.write("intrinsic/extrinsic_color.txt", matrix_text(extrinsic.matrix()));
    folder.write("intrinsic/extrinsic_depth.txt", matrix_text(extrinsic.matrix()));
    auto source = open();
    ASSERT_EQ(source->size(), 4u);
    EXPECT_EQ(source->camera().intrinsics, (Intrinsics{60, 60, 31.5f, 23.5f, 64, 48}));
    EXPECT_EQ(source->camera().depth_scale, 1000);
    EXPECT_TRUE(source->facts().warnings.empty()) << all(source->facts().warnings);
    const RawDepth depth = source->read(0).depth;
    ASSERT_EQ(depth.width(), 64);
    for (const std::uint16_t d : depth) EXPECT_EQ(d, 2000) << "the depth camera sees more than colour";
    const auto truth = source->groundtruth();
    ASSERT_TRUE(truth);
    ASSERT_EQ(truth->size(), 3u) << "where the camera was lost there is no pose";
    EXPECT_EQ(truth->at(1).stamp, source->facts().frames[2].stamp);
    EXPECT_EQ(truth->at(2).stamp, source->facts().frames[3].stamp);
    EXPECT_TRUE(truth->at(0).T_world_camera.isApprox(kPose, 1e-9));

    // a depth camera half a metre behind colour: what it measures at 2 m is 1.5 m from colour
    extrinsic.translation().z() = 0.5;
    folder.write("intrinsic/extrinsic_color.txt", matrix_text(extrinsic.matrix()));
    EXPECT_FLOAT_EQ(metres(*open()), 1.5f);
    folder.write("intrinsic/extrinsic_color.txt", "1 2 3\n");
    EXPECT_TRUE(has(fault(), "extrinsic_color.txt: holds no rigid motion"));
    std::filesystem::remove(folder / "intrinsic/extrinsic_color.txt");

    // images that somebody shrank, with the camera of those that were
    folder.write("intrinsic/intrinsic_color.txt", "1170 0 646 0\n0 1170 490 0\n0 0 1 0\n0 0 0 1\n");
    EXPECT_TRUE(has(fault(), "its principal point lies outside of the colour images (64x48)")) << fault();
}

/// Exports leave out frames: 50 is still the number of a frame.
TEST_F(Layout, ScanNetWithOneOfFiftyFrames) {
    for (const int i : {0, 50, 100}) {
        write_color("color/" + std::to_string(i) + ".jpg");
        write_depth("depth/" + std::to_string(i) + ".png", 2000);
        folder.write("pose/" + std::to_string(i) + ".txt", matrix_text(kPose.matrix()));
    }
    folder.write("intrinsic/intrinsic_color.txt", "30 0 15.5 0\n0 30 11.5 0\n0 0 1 0\n0 0 0 1\n");
    const auto source = open();
    ASSERT_EQ(source->size(), 3u);
    EXPECT_EQ(source->facts().frames[2].stamp_text, "3.333333");
    EXPECT_EQ(source->groundtruth()->size(), 3u);
    EXPECT_TRUE(source->facts().warnings.empty()) << all(source->facts().warnings);
}

/// results/frame000000.jpg and depth000000.png, traj.txt with a matrix a line; the camera lies above the folder.
TEST_F(Layout, Replica) {
    std::string poses;
    for (int i = 0; i < 3; ++i) {
        const std::string number = "00000" + std::to_string(i);
        write_color("room0/results/frame" + number + ".jpg", 1200, 680);
        write_depth("room0/results/depth" + number + ".png", 13107, 1200, 680);
        const Eigen::Isometry3d T = Eigen::Translation3d(i, 0, 0) * kPose;
        for (const double m : T.matrix().transpose().reshaped()) poses += std::to_string(m) + " ";
        poses += "\n";
    }
    folder.write("room0/traj.txt", poses);
    auto source = open_source(folder / "room0");
    ASSERT_EQ(source->size(), 3u);
    EXPECT_EQ(source->camera().intrinsics, replica_camera().intrinsics);
    EXPECT_NEAR(metres(*source), 2, 1e-4);
    EXPECT_EQ(source->facts().frames[1].stamp_text, "0.033333");
    EXPECT_TRUE(source->facts().warnings.empty()) << all(source->facts().warnings);
    const auto truth = source->groundtruth();
    ASSERT_TRUE(truth);
    ASSERT_EQ(truth->size(), 3u);
    EXPECT_EQ(truth->at(2).stamp, source->facts().frames[2].stamp);
    EXPECT_NEAR(truth->at(2).T_world_camera.translation().x(), 2 + kPose.translation().x(), 1e-5);

    folder.write("cam_params.json",
                 R"({"camera": {"w": 1200, "h": 680, "fx": 610, "fy": 610, "cx": 599.5, "cy": 339.5, "scale": 5000}})");
    source = open_source(folder / "room0");
    EXPECT_EQ(source->camera().intrinsics.fx, 610);
    EXPECT_EQ(source->camera().depth_scale, 5000);
}

/// image/ and depth/ of files NUMBER-MICROSECONDS, intrinsics.txt. Redwood's are alike, in plain millimetres.
TEST_F(Layout, Sun3dAndRedwood) {
    const auto rotated = [](std::uint16_t mm) { return static_cast<std::uint16_t>(mm << 3 | mm >> 13); };
    for (const bool redwood : {false, true}) {
        for (int i = 0; i < 12; ++i) {
            const auto name = [](int number, int us) {
                const std::string n = std::to_string(number), t = std::to_string(us);
                return std::string(7 - n.size(), '0') + n + "-" + std::string(12 - t.size(), '0') + t;
            };
            RawDepth depth(kWidth, kHeight);  // 2003 + i in the middle; nothing in the first frame
            for (int v = 0; v < kHeight; ++v)
                for (int u = 0; u < kWidth; ++u) {
                    const auto mm = static_cast<std::uint16_t>(2003 + i + u - kWidth / 2 + 8 * (v - kHeight / 2));
                    depth(u, v) = redwood ? mm : rotated(mm);
                }
            if (i == 0) depth = RawDepth(kWidth, kHeight);
            write_color("image/" + name(i + 1, 33366 * i) + ".jpg");
            // the depth camera began one frame earlier
            std::filesystem::create_directories(folder / "depth");
            write_raw_depth(folder / ("depth/" + name(i + 2, 33366 * i + 217) + ".png"), depth);
        }
        folder.write("intrinsics.txt", "30 0 15.5\n0 30 11.5\n0 0 1\n");
        const auto source = open();
        ASSERT_EQ(source->size(), 12u);
        EXPECT_EQ(source->facts().frames[1].stamp, std::chrono::microseconds(33366));
        EXPECT_EQ(source->camera().intrinsics, (Intrinsics{30, 30, 15.5f, 11.5f, kWidth, kHeight}));
        for (const std::size_t i : {1u, 11u})
            EXPECT_FLOAT_EQ(metres(*source, i), 2.003f + 0.001f * static_cast<float>(i)) << redwood;
        EXPECT_EQ(has(all(source->facts().warnings), "rotated by three"), !redwood);

        std::filesystem::remove(folder / "intrinsics.txt");  // Redwood's scans have none
        SourceOptions options;
        options.camera_file = folder.write("own.txt", "30 0 15.5\n0 30 11.5\n0 0 1\n");
        EXPECT_FLOAT_EQ(metres(*open(options), 1), 2.004f) << redwood;
    }
}

TEST_F(Layout, SevenScenes) {
    write_camera_file(folder / "camera.yaml", test_camera());
    for (const char* number : {"000000", "000001"}) {
        const std::string name = std::string("frame-") + number;
        write_color(name + ".color.png");
        write_depth(name + ".depth.png", 1500);
        folder.write(name + ".pose.txt", matrix_text(kPose.matrix()));
    }
    const auto source = open();
    ASSERT_EQ(source->size(), 2u);
    ASSERT_TRUE(source->groundtruth());
    EXPECT_EQ(source->groundtruth()->at(1).stamp, source->facts().frames[1].stamp);
}

/// TUM's lists, and calibration.txt with four numbers; the size is that of the images.
TEST_F(Layout, Eth3d) {
    write_color("rgb/1.png", 739, 458);
    write_depth("depth/1.png", 10000, 739, 458);
    folder.write("rgb.txt", "5127.3 rgb/1.png\n");
    folder.write("depth.txt", "5127.3 depth/1.png\n");
    folder.write("groundtruth.txt", "5127.3 1 2 3 0 0 0 1\n");
    folder.write("calibration.txt", "726.28741455078 726.28741455078 354.6496887207 186.46566772461\n");
    const auto source = open();
    EXPECT_EQ(source->camera().intrinsics,
              (Intrinsics{726.28741455078f, 726.28741455078f, 354.6496887207f, 186.46566772461f, 739, 458}));
    EXPECT_FLOAT_EQ(metres(*source), 2);
    EXPECT_EQ(source->groundtruth()->size(), 1u);
}

TEST_F(Layout, Bonn) {
    const TempFolder& here = folder;
    const std::string name = "rgbd_bonn_balloon";
    write_color(name + "/rgb/1.png", 640, 480);
    write_depth(name + "/depth/1.png", 10000, 640, 480);
    here.write(name + "/rgb.txt", "1548266469.88 rgb/1.png\n");
    here.write(name + "/depth.txt", "1548266469.87 depth/1.png\n");
    const auto source = open_source(here / name);
    EXPECT_EQ(source->camera().intrinsics, bonn_camera().intrinsics);
    EXPECT_TRUE(source->camera().distorted());
    EXPECT_FLOAT_EQ(metres(*source), 2);
}

/// An iPhone's: depth of 256x192 for colour of 960x720.
TEST_F(Layout, DepthOfTheSameCameraInAnotherSize) {
    folder.write("camera.yaml", "fx: 848\nfy: 848\ncx: 479.5\ncy: 359.5\nwidth: 960\nheight: 720\ndepth_scale: 1000\n");
    write_color("rgb/0.png", 960, 720);
    write_depth("depth/0.png", 2500, 256, 192);
    auto source = open();
    EXPECT_TRUE(has(all(source->facts().warnings), "they are taken to be of one camera"));
    EXPECT_EQ(source->read(0).depth.width(), 960);
    EXPECT_FLOAT_EQ(metres(*source), 2.5f);
    folder.write("camera.yaml",
                 "fx: 848\nfy: 848\ncx: 479.5\ncy: 359.5\nwidth: 960\nheight: 720\ndepth_scale: 1000\n"
                 "depth_width: 256\ndepth_height: 192\n");
    source = open();
    EXPECT_TRUE(source->facts().warnings.empty()) << "said, not assumed";
    EXPECT_FLOAT_EQ(metres(*source), 2.5f);
}

TEST_F(Layout, DepthOfAnotherCameraNeedsThatCamera) {
    const std::string color = "fx: 60\nfy: 60\ncx: 31.5\ncy: 23.5\nwidth: 64\nheight: 48\ndepth_scale: 1000\n";
    folder.write("camera.yaml", color);
    write_color("rgb/0.png", 64, 48);
    write_depth("depth/0.png", 2500, 40, 36);
    EXPECT_TRUE(has(fault(), "depth images are 40x36, colour is 64x48, and they are not of one camera; give depth_fx"));
    folder.write("camera.yaml", color +
                                    "depth_fx: 30\ndepth_fy: 30\ndepth_cx: 19.5\ndepth_cy: 17.5\ndepth_width: 40\n"
                                    "depth_height: 36\nT_color_depth: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0.1, 0, 0, "
                                    "0, 1]\n");
    EXPECT_FLOAT_EQ(metres(*open()), 2.6f);
    folder.write("camera.yaml", color + "depth_width: 32\ndepth_height: 24\n");
    EXPECT_TRUE(has(fault(), "the depth images are 40x36, but the camera says depth_width and depth_height 32x24"));
}

TEST_F(Layout, DepthInFloatMetres) {
    folder.write("camera.yaml", "fx: 30\nfy: 30\ncx: 15.5\ncy: 11.5\nwidth: 32\nheight: 24\n");
    for (const char* ending : {"tiff", "exr"}) {
        write_color("rgb/0.png");
        std::filesystem::remove_all(folder / "depth");
        std::filesystem::create_directories(folder / "depth");
        const std::string file = (folder / (std::string("depth/0.") + ending)).string();
        ASSERT_TRUE(cv::imwrite(file, cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(1.2346))));
        EXPECT_NEAR(metres(*open()), 1.2346f, 0.0001f) << ending;
        ASSERT_TRUE(cv::imwrite(file, cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(1234.6))));
        EXPECT_TRUE(has(fault(), "the median of its float depth is 1234.60 m")) << fault();
        SourceOptions millimetres;
        millimetres.camera_file =
            folder.write("mm.yaml", "fx: 30\nfy: 30\ncx: 15.5\ncy: 11.5\nwidth: 32\nheight: 24\ndepth_scale: 1000\n");
        EXPECT_NEAR(metres(*open(millimetres)), 1.2346f, 0.0001f) << ending;
    }
}

/// Whatever OpenCV writes without loss.
TEST_F(Layout, ImagesOfManyFormats) {
    write_camera_file(folder / "camera.yaml", test_camera());
    std::filesystem::create_directories(folder / "rgb");
    std::filesystem::create_directories(folder / "depth");
    const auto name = [&](const char* part, std::size_t i, const std::string& ending) {
        return (folder / (part + std::string("/") + std::to_string(i) + ending)).string();
    };
    const std::vector<std::pair<std::string, std::string>> endings{
        {".png", ".png"}, {".bmp", ".tiff"}, {".webp", ".pgm"}, {".tif", ".PNG"}, {".ppm", ".tif"}};
    for (std::size_t i = 0; i < endings.size(); ++i) {
        const std::vector<int> lossless{cv::IMWRITE_WEBP_QUALITY, 101};
        ASSERT_TRUE(cv::imwrite(name("rgb", i, endings[i].first),
                                cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar(200, 120, 10)), lossless));
        ASSERT_TRUE(cv::imwrite(name("depth", i, endings[i].second),
                                cv::Mat(kHeight, kWidth, CV_16UC1, cv::Scalar(1500 + static_cast<int>(i)))));
    }
    ASSERT_TRUE(cv::imwrite(name("rgb", 5, ".pgm"), cv::Mat(kHeight, kWidth, CV_8UC1, cv::Scalar(77))));
    ASSERT_TRUE(cv::imwrite(name("depth", 5, ".png"), cv::Mat(kHeight, kWidth, CV_16UC1, cv::Scalar(1505))));
    const auto source = open();
    ASSERT_EQ(source->size(), 6u);
    for (std::size_t i = 0; i < 6; ++i) {
        const RawFrame frame = source->read(i);
        EXPECT_EQ(frame.color(7, 7), (i < 5 ? Rgb8{10, 120, 200} : Rgb8{77, 77, 77})) << frame.color_name;
        EXPECT_EQ(frame.depth(7, 7), 1500 + i) << frame.depth_name;
    }
}

/// The unit of a known camera is that of its 16-bit images.
TEST_F(Layout, DepthInFloatMetresOfAKnownCamera) {
    const TempFolder& here = folder;
    std::filesystem::create_directories(here / "fr1_desk/depth");
    write_color("fr1_desk/rgb/0.png", 640, 480);
    ASSERT_TRUE(cv::imwrite((here / "fr1_desk/depth/0.tiff").string(), cv::Mat(480, 640, CV_32FC1, cv::Scalar(1.25))));
    EXPECT_FLOAT_EQ(metres(*open_source(here / "fr1_desk")), 1.25f);
}

TEST_F(Layout, DepthOfEightBitsIsNamed) {
    write_camera_file(folder / "camera.yaml", test_camera());
    write_color("rgb/0.png");
    std::filesystem::create_directories(folder / "depth");
    write_labels(folder / "depth/0.png", LabelImage(kWidth, kHeight, 90));
    const auto source = open();
    EXPECT_TRUE(has(message_of<Error>([&] { (void)source->read(0); }),
                    "depth/0.png: is an 8-bit image: 256 steps are a picture of depth"));
}

/// The unit of depth is that of the layout where the file does not say it.
TEST_F(Layout, CameraFilesOfOtherPrograms) {
    write_color("rgb/0.png");
    write_depth("depth/0.png", 3000);
    const std::string matrix = "30 0 15.5\n0 30 11.5\n0 0 1\n",
                      open3d =
                          R"({"width": 32, "height": 24, "intrinsic_matrix": [30, 0, 0, 0, 30, 0, 15.5, 11.5, 1]})",
                      ros =
                          "image_width: 32\nimage_height: 24\n"
                          "camera_matrix: {rows: 3, cols: 3, data: [30, 0, 15.5, 0, 30, 11.5, 0, 0, 1]}\n",
                      own = "fx: 30\nfy: 30\ncx: 15.5\ncy: 11.5\nwidth: 32\nheight: 24\n";
    struct Case {
        std::string name, content;
        float depth_scale;
    };
    for (const auto& [name, content, depth_scale] :
         {Case{"camera.yaml", own, 5000}, Case{"camera.yml", own, 5000},
          Case{"calibration.txt", "30 30 15.5 11.5\n", 5000}, Case{"intrinsics.txt", matrix, 1000},
          Case{"camera-intrinsics.txt", matrix, 1000}, Case{"intrinsic.json", open3d, 1000},
          Case{"camera_intrinsic.json", open3d, 1000}, Case{"camera_info.yaml", ros, 1000}}) {
        folder.write(name, content);
        const auto source = open();
        EXPECT_EQ(source->camera().intrinsics, (Intrinsics{30, 30, 15.5f, 11.5f, kWidth, kHeight})) << name;
        EXPECT_FLOAT_EQ(metres(*source), 3000 / depth_scale) << name;
        std::filesystem::remove(folder / name);
    }
}

/// A negative fy, as ICL-NUIM gives it: y points up in camera and world.
TEST_F(Layout, GroundTruthOfACameraWithYUpIsTurned) {
    folder.write("camera.yaml", "fx: 30\nfy: -30\ncx: 15.5\ncy: 11.5\nwidth: 32\nheight: 24\n");
    write_color("rgb/1.png");
    write_depth("depth/1.png", 10000);
    folder.write("associations.txt", "1 rgb/1.png 1 depth/1.png\n");
    folder.write("groundtruth.txt", "1 0.5 0.25 -2 0 0 0 1\n");
    const auto source = open();
    EXPECT_FLOAT_EQ(source->camera().intrinsics.fy, 30);
    EXPECT_TRUE(source->groundtruth()->at(0).T_world_camera.translation().isApprox(Eigen::Vector3d(0.5, -0.25, -2)));
}

}  // namespace
}  // namespace posefusion::test
