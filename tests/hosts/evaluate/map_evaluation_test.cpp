#include "hosts/evaluate/map_evaluation.hpp"

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "hosts/io/image_file.hpp"
#include "hosts/io/ply.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

constexpr int kWidth = 64, kHeight = 48;
constexpr float kWall = 2.0f, kPerson = 1.2f;

/// A camera that slides along a wall, 5 cm a frame, while somebody stands in the left half of the last picture. Its
/// ground truth lives in a world of its own. The run's world is its first camera.
class SlidingCamera : public testing::Test {
protected:
    void SetUp() override {
        std::filesystem::create_directories(folder / "recording/masks");
        std::filesystem::create_directories(folder / "recording/rgb");
        std::filesystem::create_directories(folder / "run");
        folder.write("recording/camera.yaml",
                     "fx: 60\nfy: 60\ncx: 31.5\ncy: 23.5\nwidth: 64\nheight: 48\ndepth_scale: 5000\n");
        T_truth_run.translation() = Eigen::Vector3d(5, -3, 1);
        T_truth_run.linear() = Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, 1, 0).normalized()).toRotationMatrix();
        std::string lists;
        Trajectory truth, estimate;
        for (int i = 0; i < 4; ++i) {
            const std::string stamp = std::to_string(i) + ".000000";
            lists += stamp + " rgb/" + stamp + ".png " + stamp + " rgb/" + stamp + "d.png\n";
            DepthImage depth(kWidth, kHeight, kWall);
            LabelImage labels(kWidth, kHeight);
            for (int v = 0; i == 3 && v < kHeight; ++v)
                for (int u = 0; u < kWidth / 2; ++u) depth(u, v) = kPerson, labels(u, v) = 1;
            write_png(folder / ("recording/rgb/" + stamp + ".png"), ColorImage(kWidth, kHeight, {90, 120, 150}));
            write_depth(folder / ("recording/rgb/" + stamp + "d.png"), depth, 5000);
            write_labels(folder / ("recording/masks/" + stamp + ".png"), labels);
            StampedPose pose;
            pose.stamp = std::chrono::seconds(i);
            pose.T_world_camera.translation().x() = 0.05 * i;
            pose.T_world_camera.translation().y() = i == 2 ? 0.02 : 0;
            estimate.push_back(pose);
            pose.T_world_camera = T_truth_run * pose.T_world_camera;
            truth.push_back(pose);
        }
        folder.write("recording/associations.txt", lists);
        write_trajectory(folder / "recording/groundtruth.txt", truth);
        write_trajectory(folder / "run/trajectory.txt", estimate);
        std::vector<Surfel> map(4);
        for (Surfel& s : map) s.normal = {0, 0, -1};
        map[0].position = {0.2f, 0.1f, kWall};
        map[1].position = {-0.2f, 0.1f, kWall};
        map[2].position = {0.2f, -0.1f, kWall};
        map[3].position = {-0.1f, 0.0f, kPerson};
        write_ply(folder / "run/map.ply", map);
    }

    test::TempFolder folder;
    Eigen::Isometry3d T_truth_run = Eigen::Isometry3d::Identity();
};

TEST_F(SlidingCamera, TheRemainsOfAPersonAreFound) {
    const MapEvaluation e = evaluate_map(folder / "recording", folder / "run", {}, folder / "ghosts.ply");
    EXPECT_EQ(e.by_first_pose.surfels, 4u);
    EXPECT_EQ(e.by_first_pose.ghosts, 1u);
    EXPECT_EQ(e.by_trajectory.ghosts, 1u);
    const auto painted = read_ply(folder / "ghosts.ply");
    EXPECT_EQ(painted[3].color, (Rgb8{255, 0, 0}));
    EXPECT_FALSE(painted[0].color == (Rgb8{255, 0, 0}));
    EXPECT_NE(map_evaluation_table(e).find("25.000 %"), std::string::npos) << map_evaluation_table(e);
    EXPECT_NE(map_evaluation_json(e).find("\"fraction\": 0.25"), std::string::npos);
}

TEST_F(SlidingCamera, ASecondWallIsCounted) {
    std::vector<Surfel> map;
    for (const float z : {kWall, kWall + 0.06f})
        for (int i = 0; i < 20; ++i)
            for (int j = 0; j < 20; ++j) {
                Surfel& s = map.emplace_back();
                s.position = {0.01f * static_cast<float>(i), 0.01f * static_cast<float>(j), z};
                s.normal = {0, 0, -1};
                s.created = z > kWall ? 250 : 3;
            }
    map.resize(600);  // half of the second wall
    write_ply(folder / "run/map.ply", map);
    const MapEvaluation e = evaluate_map(folder / "recording", folder / "run", {}, folder / "painted.ply");
    EXPECT_GE(e.duplicate_surface.duplicated, 400u);
    EXPECT_LE(e.duplicate_surface.duplicated, 460u);
    EXPECT_EQ(e.duplicate_surface.revisited, e.duplicate_surface.duplicated);
    EXPECT_EQ(read_ply(folder / "painted.ply")[0].color, (Rgb8{255, 255, 0}));
    EXPECT_NE(map_evaluation_table(e).find("have a second layer"), std::string::npos);
    EXPECT_NE(map_evaluation_json(e).find("\"revisited_fraction\""), std::string::npos);
}

TEST_F(SlidingCamera, WithoutMasksThePersonCountsAsStatic) {
    std::filesystem::remove_all(folder / "recording/masks");
    EXPECT_EQ(evaluate_map(folder / "recording", folder / "run").by_first_pose.ghosts, 0u);
}

TEST_F(SlidingCamera, WhatIsMissingIsNamed) {
    const auto message = [&] {
        return test::message_of<Error>([&] { (void)evaluate_map(folder / "recording", folder / "run"); });
    };
    std::filesystem::remove(folder / "recording/groundtruth.txt");
    EXPECT_NE(message().find("no groundtruth.txt"), std::string::npos) << message();
    std::filesystem::remove(folder / "run/trajectory.txt");
    EXPECT_NE(message().find("trajectory.txt"), std::string::npos) << message();
    write_ply(folder / "run/map.ply", {});
    EXPECT_NE(message().find("holds no surfels"), std::string::npos) << message();
    std::filesystem::remove(folder / "run/map.ply");
    EXPECT_NE(message().find("map.ply"), std::string::npos) << message();
}

}  // namespace
}  // namespace posefusion
