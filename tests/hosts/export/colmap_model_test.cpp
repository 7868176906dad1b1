#include "hosts/export/colmap_model.hpp"

#include <gtest/gtest.h>

#include "tests/hosts/support/temp_folder.hpp"

/// data_sets_test.py reads the files back, text and binary; here is what they look like.
namespace posefusion::test {
namespace {

ColmapModel some_model() {
    ColmapModel model;
    model.camera.intrinsics = {500, 510, 319.5f, 239.5f, 640, 480};
    ColmapImage image{"1.5.png"};
    image.T_world_camera.translation() = Eigen::Vector3d(1, 2, 3);
    image.points = {{{10, 20.25f}, 1}};
    model.images = {image, {"2.png"}};
    model.points = {{{0.5f, -1, 2}, {1, 2, 255}}, {{4, 5, 6}, {7, 8, 9}}};
    return model;
}

/// Without the comments at its beginning.
std::string lines_of(const std::filesystem::path& file) {
    std::string text = read_all(file);
    while (text.starts_with('#')) text = text.substr(text.find('\n') + 1);
    return text;
}

TEST(ColmapModel, TextCountsFromOneAndPixelsFromTheCorner) {
    const TempFolder folder;
    write_colmap_model(folder.path(), some_model());
    EXPECT_EQ(lines_of(folder / "cameras.txt"), "1 PINHOLE 640 480 500 510 320 240\n");
    EXPECT_EQ(lines_of(folder / "images.txt"),
              "1 1 0 0 0 -1 -2 -3 1 1.5.png\n10.5 20.75 2\n"
              "2 1 0 0 0 0 0 0 1 2.png\n\n");
    EXPECT_EQ(lines_of(folder / "points3D.txt"), "1 0.5 -1 2 1 2 255 0\n2 4 5 6 7 8 9 0 1 0\n");
}

TEST(ColmapModel, TheCameraHasWhatItsLensNeeds) {
    const TempFolder folder;
    ColmapModel model = some_model();
    model.camera.distortion = {0.5f, 0.25f, 0.125f, -0.5f};
    write_colmap_model(folder.path(), model);
    EXPECT_EQ(lines_of(folder / "cameras.txt"), "1 OPENCV 640 480 500 510 320 240 0.5 0.25 0.125 -0.5\n");
    model.camera.distortion[6] = 2;
    write_colmap_model(folder.path(), model);
    EXPECT_EQ(lines_of(folder / "cameras.txt"), "1 FULL_OPENCV 640 480 500 510 320 240 0.5 0.25 0.125 -0.5 0 0 2 0\n");
}

TEST(ColmapModel, BinaryFilesHaveTheSizesOfTheirRecords) {
    const TempFolder folder;
    write_colmap_model(folder.path(), some_model());
    EXPECT_EQ(std::filesystem::file_size(folder / "cameras.bin"), 8 + 4 + 4 + 8 + 8 + 4 * 8u);
    EXPECT_EQ(std::filesystem::file_size(folder / "images.bin"), 8 + 2 * (4 + 7 * 8 + 4 + 8) + 8 + 6 + 24u);
    EXPECT_EQ(std::filesystem::file_size(folder / "points3D.bin"), 8 + 2 * (8 + 24 + 3 + 8 + 8) + 8u);
}

}  // namespace
}  // namespace posefusion::test
