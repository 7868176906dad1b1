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

TEST(TrajectoryFile, RoundTripKeepsNanometresAndStamps) {
    const TempFolder folder;
    Trajectory written;
    for (int i = 0; i < 50; ++i)
        written.push_back({std::chrono::microseconds(1341846315698114 + 33333 * i),
                           pose({0.1 * i, -3.0 / (i + 1), 1e-4 * i}, Eigen::Quaterniond(i - 25.5, 3, 0.1 * i, -7))});
    write_trajectory(folder / "t.txt", written);
    const Trajectory read = read_trajectory(folder / "t.txt");
    ASSERT_EQ(read.size(), written.size());
    for (std::size_t i = 0; i < read.size(); ++i) {
        EXPECT_EQ(read[i].stamp, written[i].stamp);
        EXPECT_LT((read[i].T_world_camera.matrix() - written[i].T_world_camera.matrix()).cwiseAbs().maxCoeff(), 3e-9);
    }
}

TEST(TrajectoryFile, HasOneExactForm) {
    const TempFolder folder;
    const Trajectory trajectory{{stamp_of(1.5), pose({-1e-12, 2, -0.25}, Eigen::Quaterniond(-0.5, 0.5, -0.5, 0.5))},
                                {stamp_of(2), pose({0, 0, 0}, Eigen::Quaterniond(0, 0, -1, 0))}};
    write_trajectory(folder / "t.txt", trajectory);
    EXPECT_EQ(read_all(folder / "t.txt"),
              "# timestamp tx ty tz qx qy qz qw (seconds, metres, camera to world)\n"
              "1.500000 0.000000000 2.000000000 -0.250000000 -0.500000000 0.500000000 -0.500000000 0.500000000\n"
              "2.000000 0.000000000 0.000000000 0.000000000 0.000000000 1.000000000 0.000000000 0.000000000\n");
}

TEST(TrajectoryFile, EveryFormatIsReadBack) {
    const TempFolder folder;
    Trajectory written;
    for (int i = 0; i < 50; ++i)
        written.push_back({Stamp(1403636579763555584 + 33333333LL * i),
                           pose({0.1 * i, -3.0 / (i + 1), 1e-4 * i}, Eigen::Quaterniond(i - 25.5, 3, 0.1 * i, -7))});
    for (const auto format :
         {TrajectoryFormat::Tum, TrajectoryFormat::Asl, TrajectoryFormat::Kitti, TrajectoryFormat::Matrices}) {
        write_trajectory(folder / "t", written, format);
        const TrajectoryFile read = read_trajectory_file(folder / "t");
        EXPECT_EQ(read.format, format);
        EXPECT_TRUE(read.warnings.empty());
        ASSERT_EQ(read.poses.size(), written.size()) << name_of(format);
        for (std::size_t i = 0; i < read.poses.size(); ++i) {
            EXPECT_EQ(read.poses[i].stamp, read.unit ? written[i].stamp : Stamp(std::chrono::seconds(i)));
            EXPECT_LT(
                (read.poses[i].T_world_camera.matrix() - written[i].T_world_camera.matrix()).cwiseAbs().maxCoeff(),
                3e-9);
        }
    }
}

TEST(TrajectoryFile, EurocAndKittiHaveOneExactForm) {
    const TempFolder folder;
    const Trajectory trajectory{{stamp_of(1.5), pose({-1e-12, 2, -0.25}, Eigen::Quaterniond(-0.5, 0.5, -0.5, 0.5))}};
    write_trajectory(folder / "t.csv", trajectory, TrajectoryFormat::Asl);
    EXPECT_EQ(read_all(folder / "t.csv"),
              "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y [],q_RS_z []\n"
              "1500000000,0.000000000,2.000000000,-0.250000000,0.500000000,-0.500000000,0.500000000,-0.500000000\n");
    write_trajectory(folder / "t.kitti", trajectory, TrajectoryFormat::Kitti);
    EXPECT_EQ(read_all(folder / "t.kitti"),
              "0.000000000 0.000000000 1.000000000 0.000000000 "
              "-1.000000000 0.000000000 0.000000000 2.000000000 "
              "0.000000000 -1.000000000 0.000000000 -0.250000000\n");
}

TEST(TrajectoryFile, ToleratesWhatTheBenchmarksToolsTolerate) {
    const TempFolder folder;
    const auto file = folder.write("t.txt",
                                   "\xEF\xBB\xBF# comment\r\n"
                                   "\r\n"
                                   "3.0,1,2,3,0,0,0,1.05\r\n"
                                   "  1.0\t0 0 0 0 0 0 1   extra words\r\n"
                                   "2.0 nan 0 0 0 0 0 1\n"
                                   "2.5 nan nan nan nan nan nan nan\n"
                                   "1.0 7 0 0 0 0 0 1\n"
                                   "+4.0 1e-3 -2E2 0 0 0 0 1");
    const Trajectory t = read_trajectory(file);
    ASSERT_EQ(t.size(), 3u);
    EXPECT_EQ(t[0].stamp, std::chrono::seconds(1));
    EXPECT_DOUBLE_EQ(t[0].T_world_camera.translation().x(), 7) << "of equal stamps the last counts";
    EXPECT_EQ(t[1].stamp, std::chrono::seconds(3));
    EXPECT_TRUE(t[1].T_world_camera.linear().isIdentity(1e-12)) << "quaternions are normalised";
    EXPECT_DOUBLE_EQ(t[2].T_world_camera.translation().y(), -200);
}

TEST(TrajectoryFile, WhatWasMendedIsTold) {
    const TempFolder folder;
    const auto warnings = [&](const std::string& content) {
        return read_trajectory_file(folder.write("t.txt", content)).warnings;
    };
    EXPECT_TRUE(warnings("1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n").empty());
    const auto mended = warnings("3 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n2 nan 0 0 0 0 0 1\n1 7 0 0 0 0 0 1\n");
    ASSERT_EQ(mended.size(), 3u);
    EXPECT_NE(mended[0].find("t.txt: 1 of 4 poses are not finite"), std::string::npos) << mended[0];
    EXPECT_NE(mended[1].find("not in order"), std::string::npos) << mended[1];
    EXPECT_NE(mended[2].find("1 of its time stamps were there before"), std::string::npos) << mended[2];
}

/// One pose in all formats: 90 degrees about z at (1, 2, 3).
TEST(TrajectoryFile, FormatsAreToldByTheirShape) {
    const TempFolder folder;
    const auto expect = [&](const std::string& content, TrajectoryFormat format, std::optional<TimeUnit> unit,
                            Stamp stamp) {
        const TrajectoryFile read = read_trajectory_file(folder.write("t.txt", content));
        EXPECT_EQ(read.format, format) << content;
        EXPECT_EQ(read.unit, unit) << content;
        ASSERT_EQ(read.poses.size(), 1u) << content;
        EXPECT_EQ(read.poses[0].stamp, stamp) << content;
        const Eigen::Isometry3d expected =
            pose({1, 2, 3}, Eigen::Quaterniond(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ())));
        EXPECT_TRUE(read.poses[0].T_world_camera.isApprox(expected, 1e-6)) << content;
    };
    const std::string z_w = "0 0 0.70710678 0.70710678\n", w_z = "0.70710678,0,0,0.70710678";
    const Stamp ns{1403636579763555584};
    expect("1403636579.763555584 1 2 3 " + z_w, TrajectoryFormat::Tum, TimeUnit::Seconds, ns);
    expect("1403636579763555584 1 2 3 " + z_w, TrajectoryFormat::Tum, TimeUnit::Nanoseconds, ns);
    expect("1403636579763555584.000000 1 2 3 " + z_w, TrajectoryFormat::Tum, TimeUnit::Nanoseconds, ns);
    const std::string names =
        "#timestamp [ns],p_RS_R_x [m],p_RS_R_y [m],p_RS_R_z [m],q_RS_w [],q_RS_x [],q_RS_y "
        "[],q_RS_z []";
    const std::string state = ",0.1,0.2,0.3,-1,-2,-3,4,5,6";
    expect(names + ",v_RS_R_x [m s^-1]\n1403636579763555584,1,2,3," + w_z + state + "\n", TrajectoryFormat::Asl,
           TimeUnit::Nanoseconds, ns);
    expect("1403636579763555584,1,2,3," + w_z + state + "\n", TrajectoryFormat::Asl, TimeUnit::Nanoseconds, ns);
    expect(names + "\r\n1403636579763555584,1,2,3," + w_z + "\r\n", TrajectoryFormat::Asl, TimeUnit::Nanoseconds, ns);
    expect("1403636579763555584,1,2,3," + w_z + "\n", TrajectoryFormat::Asl, TimeUnit::Nanoseconds, ns);
    expect("t,x,y,z,qw,qx,qy,qz\n1.5,1,2,3," + w_z + "\n", TrajectoryFormat::Asl, TimeUnit::Seconds,
           std::chrono::milliseconds(1500));
    expect("# timestamp tx ty tz qx qy qz qw\n1.5 1 2 3 " + z_w, TrajectoryFormat::Tum, TimeUnit::Seconds,
           std::chrono::milliseconds(1500));
    expect("1.5,1,2,3,0,0,0.70710678,0.70710678\n", TrajectoryFormat::Tum, TimeUnit::Seconds,
           std::chrono::milliseconds(1500));
    const std::string rows = "0 -1 0 1 1 0 0 2 0 0 1 3";
    expect(rows + "\n", TrajectoryFormat::Kitti, std::nullopt, Stamp{});
    expect(rows + " 0 0 0 1\n", TrajectoryFormat::Matrices, std::nullopt, Stamp{});
}

TEST(TrajectoryFile, PosesWithoutStampsAreNumbered) {
    const TempFolder folder;
    const auto file = folder.write("kitti.txt",
                                   "1 0 0 0 0 1 0 0 0 0 1 0\n"
                                   "1 0 0 nan 0 1 0 0 0 0 1 0\n"
                                   "1.000000e+00 0 0 0 0 1 0 0 0 0 1 5.000000e-01\n");
    const TrajectoryFile read = read_trajectory_file(file);
    EXPECT_EQ(read.rows, 3u);
    ASSERT_EQ(read.poses.size(), 2u);
    EXPECT_EQ(read.poses[1].stamp, std::chrono::seconds(2));
    EXPECT_EQ(read.description(), "KITTI, without stamps");
    EXPECT_NE(message_of<Error>([&] { (void)read_trajectory(file); }).find("without time stamps (KITTI)"),
              std::string::npos);
}

TEST(TrajectoryFile, WhatIsNoTrajectoryIsRefused) {
    const TempFolder folder;
    const auto fault = [&](const std::string& content) {
        const auto file = folder.write("t.txt", content);
        return message_of<Error>([&] { (void)read_trajectory_file(file); });
    };
    const auto has = [](const std::string& text, const std::string& part) {
        return text.find(part) != std::string::npos;
    };
    EXPECT_TRUE(has(fault("1 2 3 4 5 6 7\n"), "line 1: 7 numbers are no pose: expected 8 (TUM"));
    EXPECT_TRUE(has(fault("1 2 3 4 5 6 7 8 9\n"), "9 numbers are no pose"));
    EXPECT_TRUE(has(fault("1 0 0 0 0 0 0 1\n2 0 0 0 0 0 1\n"), "line 2: expected 8 numbers as in line 1, found 7"));
    EXPECT_TRUE(has(fault("1 0 0 0 0 0 0 1\n1 0 0 0 0 1 0 0 0 0 1 0\n"), "line 2: expected 8 numbers"));
    EXPECT_TRUE(has(fault("1 0 0 0 30 2 45 1\n"), "columns 5 to 8 are no quaternion")) << "angles, for example";
    EXPECT_TRUE(has(fault("1 0 0 0 0 1 0 0 0 0 2 0\n"), "not the rows of a rigid motion"));
    EXPECT_TRUE(has(fault("1 0 0 0 0 1 0 0 0 0 -1 0\n"), "not the rows of a rigid motion")) << "a mirror";
    EXPECT_TRUE(has(fault("1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 2\n"), "tz 0 0 0 1)"));
    EXPECT_TRUE(has(fault("timestamp,x,y\n"), "holds no pose"));
    EXPECT_TRUE(has(fault("99999999999 0 0 0 0 0 0 1\n"), "is no time"));
}

TEST(TrajectoryFile, StampsKeepTheirDigits) {
    const TempFolder folder;
    const auto file = folder.write("t.txt", "1403636579763555584 0 0 0 0 0 0 1\n1403636579813555456 0 0 0 0 0 0 1\n");
    write_trajectory(folder / "out.txt", read_trajectory(file));
    const std::string text = read_all(folder / "out.txt");
    EXPECT_NE(text.find("\n1403636579.763555584 0.000000000"), std::string::npos) << text;
    EXPECT_NE(text.find("\n1403636579.813555456 "), std::string::npos) << text;
}

TEST(TrajectoryFile, FaultsAreNamedWithTheirLine) {
    const TempFolder folder;
    const auto fault = [&](const std::string& content) {
        const auto file = folder.write("t.txt", content);
        return message_of<Error>([&] { (void)read_trajectory(file); });
    };
    EXPECT_NE(fault("# c\n1 2 3\n").find("t.txt, line 2: 3 numbers are no pose"), std::string::npos);
    EXPECT_NE(fault("1 0 0 0 0 0 0 1\n1 0 0 zero 0 0 0 1\n").find("line 2: 'zero' is not a number"), std::string::npos);
    EXPECT_NE(fault("1 0 0 0 0 0 0 0\n").find("line 1: columns 5 to 8 are no quaternion"), std::string::npos);
    EXPECT_NE(fault("").find("holds no pose"), std::string::npos);
    EXPECT_NE(fault("# only a comment\n1 nan 0 0 0 0 0 1\n").find("holds no pose"), std::string::npos);
    EXPECT_NE(fault(std::string("\x89PNG\r\n\x1a\n\0\0\0", 11)).find("t.txt"), std::string::npos);
    EXPECT_NE(message_of<Error>([&] { (void)read_trajectory(folder / "none.txt"); }).find("no such file"),
              std::string::npos);
    EXPECT_NE(message_of<Error>([&] { (void)read_trajectory(folder.path()); }).find("is a folder"), std::string::npos);
}

TEST(TrajectoryFile, AFullDiskIsAnError) {
    EXPECT_THROW(write_trajectory("/dev/full", {{Stamp{}, Eigen::Isometry3d::Identity()}}), Error);
}

}  // namespace
}  // namespace posefusion
