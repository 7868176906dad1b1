#include <Eigen/Geometry>

#include "hosts/io/recording.hpp"
#include "tests/hosts/io/sources/frames.hpp"

namespace posefusion::test {
namespace {

class Folder : public testing::Test {
protected:
    void SetUp() override { write_camera_file(folder / "camera.yaml", test_camera()); }
    void add(const std::string& color, const std::string& depth, int i) const {
        std::filesystem::create_directories((folder / color).parent_path());
        std::filesystem::create_directories((folder / depth).parent_path());
        write_png(folder / color, make_frame(i).color);
        write_raw_depth(folder / depth, make_frame(i).depth);
    }
    void expect_frame(std::size_t at, int i) const {
        const RawFrame read = open_source(folder.path())->read(at);
        EXPECT_EQ(read.color(9, 9), make_frame(i).color(9, 9));
        EXPECT_EQ(read.depth(9, 9), make_frame(i).depth(9, 9));
    }
    TempFolder folder;
};

TEST_F(Folder, OfNumberedImagesIsReadAtThirtyFramesPerSecond) {
    for (const int i : {0, 2, 10}) add("color/" + std::to_string(i) + ".png", "depth/" + std::to_string(i) + ".png", i);
    const auto source = open_source(folder.path());
    ASSERT_EQ(source->size(), 3u);
    EXPECT_EQ(source->facts().frames[1].stamp_text, "0.066667");
    EXPECT_EQ(source->facts().frames[2].stamp_text, "0.333333") << "10 comes after 2";
    expect_frame(0, 0);
    expect_frame(2, 10);
}

TEST_F(Folder, AsIn7Scenes) {
    add("frame-000003.color.png", "frame-000003.depth.png", 3);
    add("frame-000004.color.png", "frame-000004.depth.png", 4);
    folder.write("frame-000003.pose.txt", "1 0 0 0\n");
    EXPECT_EQ(open_source(folder.path())->size(), 2u);
    expect_frame(1, 4);
}

TEST_F(Folder, OfStampedImagesIsPairedByTime) {
    add("rgb/10.000000.png", "depth/10.010000.png", 0);
    add("rgb/10.033333.png", "depth/10.043000.png", 1);
    add("rgb/11.000000.png", "depth/11.500000.png", 2);
    const auto source = open_source(folder.path());
    ASSERT_EQ(source->size(), 2u);
    EXPECT_EQ(source->facts().frames[1].stamp_text, "10.033333");
    ASSERT_EQ(source->facts().warnings.size(), 1u);
    EXPECT_TRUE(has(source->facts().warnings[0], "2 images without partner"));
    expect_frame(1, 1);
}

TEST_F(Folder, WholeNumbersThatTellTimeAreTimeStamps) {
    const auto stamps_of_names = [](const std::vector<std::string>& names) {
        const TempFolder own;
        write_camera_file(own / "camera.yaml", test_camera());
        for (const char* part : {"rgb", "depth"}) std::filesystem::create_directories(own / part);
        for (const std::string& name : names) {
            write_png(own / ("rgb/" + name + ".png"), make_frame(0).color);
            write_raw_depth(own / ("depth/" + name + ".png"), make_frame(0).depth);
        }
        const auto source = open_source(own.path());
        std::vector<std::int64_t> nanoseconds;
        for (const FrameEntry& frame : source->facts().frames) nanoseconds.push_back(frame.stamp.count());
        EXPECT_TRUE(names.front().ends_with(source->facts().frames.front().stamp_text)) << "masks have its name";
        EXPECT_EQ(source->facts().warnings.size(), 1u);
        EXPECT_TRUE(has(source->facts().warnings.at(0), "are taken as time stamps in "));
        return nanoseconds;
    };
    using Stamps = std::vector<std::int64_t>;
    EXPECT_EQ(stamps_of_names({"1403636579763555584", "1403636579813555456"}),
              (Stamps{1403636579763555584, 1403636579813555456}));
    EXPECT_EQ(stamps_of_names({"1403636579763", "1403636579813"}), (Stamps{1403636579763000000, 1403636579813000000}));
    EXPECT_EQ(stamps_of_names({"0", "33", "67"}), (Stamps{0, 33000000, 67000000}));
    EXPECT_EQ(stamps_of_names({"0000001-000000000000", "0000002-000000033366", "0000003-000000066733"}).back(),
              66733000)
        << "SUN3D";
}

TEST_F(Folder, OfSun3dIsPairedByTheTimeInTheNames) {
    for (int i = 0; i < 3; ++i)
        add("image/000000" + std::to_string(i + 1) + "-00000" + std::to_string(1033366 * (i + 1)) + ".jpg.png",
            "depth/000000" + std::to_string(i + 2) + "-00000" + std::to_string(1033366 * (i + 1) + 217) + ".png", i);
    EXPECT_EQ(open_source(folder.path())->size(), 3u);
    expect_frame(2, 2);
}

TEST_F(Folder, NumbersThatRepeatAreTold) {
    add("rgb/left_1.png", "depth/1.png", 1);
    add("rgb/right_1.png", "depth/2.png", 2);
    const auto source = open_source(folder.path());
    EXPECT_EQ(source->size(), 1u);
    ASSERT_EQ(source->facts().warnings.size(), 2u);
    EXPECT_TRUE(has(source->facts().warnings[0], "1 colour image with a time stamp that was there before"));
    EXPECT_TRUE(has(source->facts().warnings[1], "1 image without partner"));
}

TEST_F(Folder, WithoutImagesIsRefused) {
    EXPECT_TRUE(has(open_fault(folder.path()), "is no recording"));
    add("rgb/1.png", "depth/2.png", 0);
    EXPECT_TRUE(has(open_fault(folder.path()), "same number (1.png and 2.png")) << open_fault(folder.path());
    add("rgb/3.png", "depth/3.png", 0);
    EXPECT_EQ(open_fault(folder.path()), "");
    std::filesystem::remove(folder / "camera.yaml");
    EXPECT_TRUE(has(open_fault(folder.path()), "--camera FILE"));
    folder.write("notes.txt", "hello");
    EXPECT_TRUE(has(open_fault(folder / "notes.txt"), "nor a recording that can be read"));
    EXPECT_TRUE(has(open_fault(folder / "nothing"), "not found"));
}

TEST_F(Folder, AnAssociationsFileMayLieElsewhere) {
    add("rgb/a.png", "depth/b.png", 7);
    const TempFolder* here = &folder;
    const auto list = here->write("lists/mine.txt", "5.25 rgb/a.png 5.26 depth/b.png\n");
    SourceOptions options;
    options.associations_file = list;
    const auto source = open_source(folder.path(), options);
    ASSERT_EQ(source->size(), 1u);
    EXPECT_EQ(source->facts().frames[0].stamp_text, "5.25");
    EXPECT_EQ(source->read(0).depth(9, 9), make_frame(7).depth(9, 9));
    options.associations_file = folder / "lists/none.txt";
    EXPECT_TRUE(has(open_fault(folder.path(), options), "none.txt: no such file"));
    EXPECT_TRUE(has(open_fault(list, options), "--associations has no meaning"));
}

/// ICL-NUIM's ground truth: K = (481.2, -480, ...), so y points up. What its camera sees at image row v must be what
/// ours sees there.
TEST_F(Folder, OfIclNuimHasItsCameraAndItsGroundTruthTurned) {
    std::filesystem::remove(folder / "camera.yaml");
    folder.write("associations.txt", "1 depth/1.png 1 rgb/1.png\n");
    folder.write("livingRoom0.gt.freiburg", "1 0.5 0.25 -2 0.1 0.2 0.3 0.927362\n");
    const auto source = open_source(folder.path());
    EXPECT_FLOAT_EQ(source->camera().intrinsics.fx, 481.2f);
    EXPECT_FLOAT_EQ(source->camera().intrinsics.fy, 480.0f);
    EXPECT_FLOAT_EQ(source->camera().depth_scale, 5000);
    const auto truth = source->groundtruth();
    ASSERT_TRUE(truth);
    const Eigen::Isometry3d ours = truth->at(0).T_world_camera;
    const Eigen::Isometry3d theirs =
        Eigen::Translation3d(0.5, 0.25, -2) * Eigen::Quaterniond(0.927362, 0.1, 0.2, 0.3).normalized();
    const Eigen::Vector3d up(0.3, 0.4, 1.5), down(0.3, -0.4, 1.5);  // the same point of an image, y up and y down
    const Eigen::Vector3d a = theirs * up, b = ours * down;
    EXPECT_NEAR((a - Eigen::Vector3d(b.x(), -b.y(), b.z())).norm(), 0, 1e-9) << "the same point of the room";
    EXPECT_NEAR(ours.linear().determinant(), 1, 1e-9);
}

}  // namespace
}  // namespace posefusion::test
