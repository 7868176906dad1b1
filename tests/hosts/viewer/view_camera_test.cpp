#include "hosts/viewer/view_camera.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace posefusion {
namespace {

using glm::mat4;
using glm::vec3;
using glm::vec4;

constexpr float kDistance = 4.5f;  // at the start
const mat4 kAtOrigin{1};

mat4 pose(const ViewCamera& camera, const mat4& tracked = kAtOrigin) {
    return glm::inverse(camera.T_camera_world(tracked));
}
vec3 eye(const ViewCamera& camera, const mat4& tracked = kAtOrigin) { return pose(camera, tracked)[3]; }
vec3 forward(const ViewCamera& camera) { return pose(camera)[2]; }
vec3 looked_at(const ViewCamera& camera, float distance) { return eye(camera) + distance * forward(camera); }

/// Largest difference of two matrices' elements.
float difference(const mat4& a, const mat4& b) {
    float most = 0;
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) most = std::max(most, std::abs(a[column][row] - b[column][row]));
    return most;
}

TEST(ViewCamera, StartsBehindAndAboveTheFirstCameraAndSeesWhatItSees) {
    const ViewCamera camera;
    EXPECT_LT(eye(camera).z, 0) << "behind";
    EXPECT_LT(eye(camera).y, 0) << "above: y points down";
    const vec3 seen = camera.T_camera_world(kAtOrigin) * vec4(0, 0, 2, 1);
    EXPECT_GT(seen.z, 1);
    EXPECT_LT(std::abs(seen.x), 0.5f * seen.z);
    EXPECT_LT(std::abs(seen.y), 0.5f * seen.z);
}

TEST(ViewCamera, TheHorizonStaysLevelHoweverItTurns) {
    ViewCamera camera;
    for (int i = 0; i < 50; ++i) {
        camera.orbit(37, i % 2 == 0 ? 23.0f : -31.0f);
        const glm::mat3 R(pose(camera));
        EXPECT_NEAR(R[0].y, 0, 1e-5f) << "its right is level";
        EXPECT_GT(R[1].y, 0) << "its down points down";
        EXPECT_NEAR(glm::determinant(R), 1, 1e-4f);
    }
}

TEST(ViewCamera, OrbitingKeepsTheDistanceAndZoomingTheDirection) {
    ViewCamera camera;
    const vec3 target = looked_at(camera, kDistance);
    camera.orbit(30, 10);
    EXPECT_LT(glm::distance(looked_at(camera, kDistance), target), 1e-4f);
    const vec3 before = forward(camera);
    camera.zoom(0.5f);
    EXPECT_LT(glm::distance(forward(camera), before), 1e-5f);
    EXPECT_LT(glm::distance(looked_at(camera, kDistance / 2), target), 1e-4f);
    for (int i = 0; i < 1000; ++i) camera.zoom(0.5f);
    EXPECT_GT(glm::distance(eye(camera), target), 0.01f) << "never into the point it looks at";
}

TEST(ViewCamera, TurningToTheRightLooksToTheRightAndDownDown) {
    ViewCamera camera;
    const vec3 before = forward(camera);
    camera.orbit(10, 0);
    EXPECT_GT(forward(camera).x, before.x);
    camera.orbit(0, 10);
    EXPECT_GT(forward(camera).y, before.y);
}

TEST(ViewCamera, FollowsOverTheShoulderUntilItIsTurned) {
    ViewCamera camera;
    camera.follow(true);
    const mat4 tracked = glm::rotate(glm::translate(mat4(1), {5, 0, 7}), 1.0f, {0, 1, 0});
    const vec3 in_tracked = glm::inverse(tracked) * vec4(eye(camera, tracked), 1);
    EXPECT_LT(in_tracked.z, 0);
    EXPECT_LT(in_tracked.y, 0);
    EXPECT_LT(glm::length(in_tracked), 3);
    camera.orbit(1, 1);
    EXPECT_FALSE(camera.follows());
}

TEST(ViewCamera, HomeIsWhereItBegan) {
    ViewCamera camera, moved;
    moved.orbit(100, 20);
    moved.pan(1, 2);
    moved.zoom(3);
    EXPECT_GT(difference(moved.T_camera_world(kAtOrigin), camera.T_camera_world(kAtOrigin)), 1e-3f);
    moved.home();
    EXPECT_EQ(difference(moved.T_camera_world(kAtOrigin), camera.T_camera_world(kAtOrigin)), 0);
}

}  // namespace
}  // namespace posefusion
