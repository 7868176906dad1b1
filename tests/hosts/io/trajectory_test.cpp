#include "hosts/io/trajectory.hpp"

#include <gtest/gtest.h>

#include "engine/core/error.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

using test::message_of;
using test::read_all;
using test::TempFolder;

Eigen::Isometry3d pose(const Eigen::Vector3d& t, const Eigen::Quaterniond& q) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() = t;
    T.linear() = q.normalized().toRotationMatrix();
    return T;
}

TEST(TrajectoryFile, RoundTripKeepsNanometresAndMicroseconds) {
    const TempFolder folder;
    Trajectory written;
    for (int i = 0; i < 50; ++i)
        written.push_back({1341846315.698114 + i / 30.0,
                           pose({0.1 * i, -3.0 / (i + 1), 1e-4 * i}, Eigen::Quaterniond(i - 25.5, 3, 0.1 * i, -7))});
    write_trajectory(folder / "t.txt", written);
    const Trajectory read = read_trajectory(folder / "t.txt");
    ASSERT_EQ(read.size(), written.size());
    for (std::size_t i = 0; i < read.size(); ++i) {
        EXPECT_NEAR(read[i].stamp, written[i].stamp, 5e-7 + 1e-9);
        EXPECT_LT((read[i].T_world_camera.matrix() - written[i].T_world_camera.matrix()).cwiseAbs().maxCoeff(), 3e-9);
    }
}

TEST(TrajectoryFile, HasOneExactForm) {
    const TempFolder folder;
    const Trajectory trajectory{{1.5, pose({-1e-12, 2, -0.25}, Eigen::Quaterniond(-0.5, 0.5, -0.5, 0.5))},
                                {2, pose({0, 0, 0}, Eigen::Quaterniond(0, 0, -1, 0))}};
    write_trajectory(folder / "t.txt", trajectory);
    EXPECT_EQ(read_all(folder / "t.txt"),
              "# timestamp tx ty tz qx qy qz qw (seconds, metres, camera to world)\n"
              "1.500000 0.000000000 2.000000000 -0.250000000 -0.500000000 0.500000000 -0.500000000 0.500000000\n"
              "2.000000 0.000000000 0.000000000 0.000000000 0.000000000 1.000000000 0.000000000 0.000000000\n");
}

TEST(TrajectoryFile, ToleratesWhatTheBenchmarksToolsTolerate) {
    const TempFolder folder;
    const auto file = folder.write("t.txt",
                                   "\xEF\xBB\xBF# comment\r\n"
                                   "\r\n"
                                   "3.0,1,2,3,0,0,0,2\r\n"
                                   "  1.0\t0 0 0 0 0 0 1   extra words\r\n"
                                   "2.0 nan 0 0 0 0 0 1\n"
                                   "2.5 nan nan nan nan nan nan nan\n"
                                   "1.0 7 0 0 0 0 0 1\n"
                                   "+4.0 1e-3 -2E2 0 0 0 0 1");
    const Trajectory t = read_trajectory(file);
    ASSERT_EQ(t.size(), 3u);
    EXPECT_DOUBLE_EQ(t[0].stamp, 1);
    EXPECT_DOUBLE_EQ(t[0].T_world_camera.translation().x(), 7) << "of equal stamps the last counts";
    EXPECT_DOUBLE_EQ(t[1].stamp, 3);
    EXPECT_TRUE(t[1].T_world_camera.linear().isIdentity(1e-12)) << "quaternions are normalised";
    EXPECT_DOUBLE_EQ(t[2].T_world_camera.translation().y(), -200);
}

TEST(TrajectoryFile, FaultsAreNamedWithTheirLine) {
    const TempFolder folder;
    const auto fault = [&](const std::string& content) {
        const auto file = folder.write("t.txt", content);
        return message_of<Error>([&] { (void)read_trajectory(file); });
    };
    EXPECT_NE(fault("# c\n1 2 3\n").find("t.txt, line 2: expected 8 numbers"), std::string::npos);
    EXPECT_NE(fault("1 0 0 0 0 0 0 1\n1 0 0 zero 0 0 0 1\n").find("line 2: 'zero' is not a number"), std::string::npos);
    EXPECT_NE(fault("1 0 0 0 0 0 0 0\n").find("line 1: the quaternion is zero"), std::string::npos);
    EXPECT_NE(fault("").find("holds no pose"), std::string::npos);
    EXPECT_NE(fault("# only a comment\n1 nan 0 0 0 0 0 1\n").find("holds no pose"), std::string::npos);
    EXPECT_NE(fault(std::string("\x89PNG\r\n\x1a\n\0\0\0", 11)).find("t.txt"), std::string::npos);
    EXPECT_NE(message_of<Error>([&] { (void)read_trajectory(folder / "none.txt"); }).find("no such file"),
              std::string::npos);
    EXPECT_NE(message_of<Error>([&] { (void)read_trajectory(folder.path()); }).find("is a folder"), std::string::npos);
}

TEST(TrajectoryFile, AFullDiskIsAnError) {
    EXPECT_THROW(write_trajectory("/dev/full", {{0, Eigen::Isometry3d::Identity()}}), Error);
}

}  // namespace
}  // namespace posefusion
