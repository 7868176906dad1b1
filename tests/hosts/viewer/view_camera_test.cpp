#include "hosts/viewer/view_camera.hpp"

#include <gtest/gtest.h>

namespace posefusion {
namespace {

constexpr float kDistance = 4.5f;  // at the start
const Eigen::Isometry3f kAtOrigin = Eigen::Isometry3f::Identity();

Eigen::Vector3f eye(const ViewCamera& camera, const Eigen::Isometry3f& tracked = kAtOrigin) {
    return camera.T_camera_world(tracked).inverse().translation();
}
Eigen::Vector3f forward(const ViewCamera& camera) { return camera.T_camera_world(kAtOrigin).inverse().linear().col(2); }

TEST(ViewCamera, StartsBehindAndAboveTheFirstCameraAndSeesWhatItSees) {
    const ViewCamera camera;
    EXPECT_LT(eye(camera).z(), 0) << "behind";
    EXPECT_LT(eye(camera).y(), 0) << "above: y points down";
    const Eigen::Vector3f seen = camera.T_camera_world(kAtOrigin) * Eigen::Vector3f(0, 0, 2);
    EXPECT_GT(seen.z(), 1);
    EXPECT_LT(std::abs(seen.x()), 0.5f * seen.z());
    EXPECT_LT(std::abs(seen.y()), 0.5f * seen.z());
}

TEST(ViewCamera, TheHorizonStaysLevelHoweverItTurns) {
    ViewCamera camera;
    for (int i = 0; i < 50; ++i) {
        camera.orbit(37, i % 2 == 0 ? 23.0f : -31.0f);
        const Eigen::Matrix3f R = camera.T_camera_world(kAtOrigin).inverse().linear();
        EXPECT_NEAR(R.col(0).y(), 0, 1e-5f) << "its right is level";
        EXPECT_GT(R.col(1).y(), 0) << "its down points down";
        EXPECT_NEAR(R.determinant(), 1, 1e-4f);
    }
}

TEST(ViewCamera, OrbitingKeepsTheDistanceAndZoomingTheDirection) {
    ViewCamera camera;
    const Eigen::Vector3f target = eye(camera) + kDistance * forward(camera);
    camera.orbit(30, 10);
    EXPECT_TRUE((eye(camera) + kDistance * forward(camera)).isApprox(target, 1e-4f));
    const Eigen::Vector3f before = forward(camera);
    camera.zoom(0.5f);
    EXPECT_TRUE(forward(camera).isApprox(before, 1e-5f));
    EXPECT_TRUE((eye(camera) + kDistance / 2 * forward(camera)).isApprox(target, 1e-4f));
    for (int i = 0; i < 1000; ++i) camera.zoom(0.5f);
    EXPECT_GT((eye(camera) - target).norm(), 0.01f) << "never into the point it looks at";
}

TEST(ViewCamera, TurningToTheRightLooksToTheRightAndDownDown) {
    ViewCamera camera;
    const Eigen::Vector3f before = forward(camera);
    camera.orbit(10, 0);
    EXPECT_GT(forward(camera).x(), before.x());
    camera.orbit(0, 10);
    EXPECT_GT(forward(camera).y(), before.y());
}

TEST(ViewCamera, FollowsOverTheShoulderUntilItIsTurned) {
    ViewCamera camera;
    camera.follow(true);
    Eigen::Isometry3f tracked = Eigen::Isometry3f::Identity();
    tracked.linear() = Eigen::AngleAxisf(1.0f, Eigen::Vector3f::UnitY()).toRotationMatrix();
    tracked.translation() = Eigen::Vector3f(5, 0, 7);
    const Eigen::Vector3f in_tracked = tracked.inverse() * eye(camera, tracked);
    EXPECT_LT(in_tracked.z(), 0);
    EXPECT_LT(in_tracked.y(), 0);
    EXPECT_LT(in_tracked.norm(), 3);
    camera.orbit(1, 1);
    EXPECT_FALSE(camera.follows());
}

TEST(ViewCamera, HomeIsWhereItBegan) {
    ViewCamera camera, moved;
    moved.orbit(100, 20);
    moved.pan(1, 2);
    moved.zoom(3);
    EXPECT_FALSE(moved.T_camera_world(kAtOrigin).isApprox(camera.T_camera_world(kAtOrigin), 1e-3f));
    moved.home();
    EXPECT_TRUE(moved.T_camera_world(kAtOrigin).isApprox(camera.T_camera_world(kAtOrigin)));
}

}  // namespace
}  // namespace posefusion
