#include "hosts/report/upright.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace posefusion {
namespace {

/// A room seen by a camera that looks down by `tilt`: floor, table and a wall.
std::vector<Surfel> room(const Eigen::Vector3d& up, const Eigen::Vector3d& forward) {
    std::vector<Surfel> map(3000);
    for (std::size_t i = 0; i < map.size(); ++i) {
        Eigen::Vector3d normal = i % 3 == 0 ? up : Eigen::Vector3d(-forward);
        normal += 0.05 * Eigen::Vector3d(std::sin(1.1 * static_cast<double>(i)), std::cos(0.7 * static_cast<double>(i)),
                                         std::sin(2.3 * static_cast<double>(i)));
        map[i].normal = normal.normalized().cast<float>();
    }
    return map;
}

TEST(Upright, TheFloorTellsWhereUpIs) {
    const double tilt = 35 * std::numbers::pi / 180;
    const Eigen::Vector3d up(0, -std::cos(tilt), -std::sin(tilt)), forward(0, -std::sin(tilt), std::cos(tilt));
    Trajectory trajectory(1);
    const Eigen::Isometry3d axes = upright_axes(room(up, forward), trajectory);
    EXPECT_GT(axes.linear().col(2).dot(up), std::cos(1.0 * std::numbers::pi / 180));
    EXPECT_GT(axes.linear().col(1).dot(forward), std::cos(1.0 * std::numbers::pi / 180));
    EXPECT_TRUE(axes.linear().isUnitary(1e-9));
    EXPECT_NEAR(axes.linear().determinant(), 1, 1e-9);
}

TEST(Upright, WithoutAMapTheCamerasTell) {
    Trajectory trajectory(2);
    trajectory[0].T_world_camera.translation().x() = 3;
    const Eigen::Isometry3d axes = upright_axes({}, trajectory);
    EXPECT_TRUE(axes.linear().col(0).isApprox(Eigen::Vector3d(1, 0, 0), 1e-9));
    EXPECT_TRUE(axes.linear().col(1).isApprox(Eigen::Vector3d(0, 0, 1), 1e-9));
    EXPECT_TRUE(axes.linear().col(2).isApprox(Eigen::Vector3d(0, -1, 0), 1e-9));
    EXPECT_DOUBLE_EQ(axes.translation().x(), 3);
}

TEST(Upright, ACameraThatLooksStraightDownHasAxesToo) {
    std::vector<Surfel> map(100);
    for (Surfel& s : map) s.normal = {0, 0, -1};
    Trajectory trajectory(1);
    trajectory[0].T_world_camera.linear() = Eigen::AngleAxisd(0.8, Eigen::Vector3d::UnitX()).toRotationMatrix();
    const Eigen::Isometry3d axes = upright_axes(map, trajectory);
    EXPECT_TRUE(axes.matrix().allFinite());
    EXPECT_TRUE(upright_axes({}, {}).matrix().allFinite());
    EXPECT_NEAR(axes.linear().determinant(), 1, 1e-9);
}

}  // namespace
}  // namespace posefusion
