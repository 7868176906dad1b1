#include "hosts/io/depth_registration.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "engine/core/error.hpp"
#include "tests/hosts/support/temp_folder.hpp"

namespace posefusion {
namespace {

using test::message_of;

constexpr float kMillimetres = 1000;

/// A colour camera and a depth camera beside it, with other lenses and turned by three degrees.
Camera color_camera() { return {{230, 232, 130.5f, 95.25f, 260, 194}, kMillimetres, {0.1f, -0.2f, 0.001f, -0.002f}}; }

DepthCamera depth_camera() {
    DepthCamera camera{{115, 114, 63.5f, 49.5f, 128, 96}, {0.09f, -0.27f, 0, 0, 0.09f}, Eigen::Isometry3f::Identity()};
    camera.T_color_depth.linear() =
        Eigen::AngleAxisf(0.05f, Eigen::Vector3f(0.2f, 1, 0.1f).normalized()).toRotationMatrix();
    camera.T_color_depth.translation() = Eigen::Vector3f(0.052f, -0.003f, 0.002f);
    return camera;
}

/// A plane n . p = d of the colour camera's space.
struct Plane {
    Eigen::Vector3f n;
    float d;
};

/// Where the ray of a pixel meets the plane, as z in the camera's own space. @param T_color_camera  of that camera
float z_on_plane(const Intrinsics& K, const LensCoefficients& lens, const Eigen::Isometry3f& T_color_camera,
                 const Plane& plane, int u, int v) {
    const PlanePoint p =
        undistort({(static_cast<float>(u) - K.cx) / K.fx, (static_cast<float>(v) - K.cy) / K.fy}, lens);
    const Eigen::Vector3f ray(p.x, p.y, 1);
    const float along = plane.n.dot(T_color_camera.linear() * ray);
    return (plane.d - plane.n.dot(T_color_camera.translation())) / along;
}

RawDepth measured(const DepthCamera& camera, const Plane& plane) {
    RawDepth depth(camera.intrinsics.width, camera.intrinsics.height);
    for (int v = 0; v < depth.height(); ++v)
        for (int u = 0; u < depth.width(); ++u)
            depth(u, v) = static_cast<std::uint16_t>(std::lround(
                kMillimetres * z_on_plane(camera.intrinsics, camera.distortion, camera.T_color_depth, plane, u, v)));
    return depth;
}

/// Does the depth image of the sensor go on around that pixel?
bool inside(const RawDepth& depth, int u, int v) {
    constexpr int kFar = 3;  // pixels of colour: one and a half of depth
    for (int y = v - kFar; y <= v + kFar; ++y)
        for (int x = u - kFar; x <= u + kFar; ++x)
            if (!depth.contains(x, y) || depth(x, y) == 0) return false;
    return true;
}

TEST(DepthRegistration, APlaneIsWhereTheColourCameraSeesIt) {
    const Camera color = color_camera();
    const DepthCamera camera = depth_camera();
    const DepthRegistration registration(camera, color);
    EXPECT_EQ(registration.depth_size(), (ImageSize{128, 96}));
    for (const Plane& plane : {Plane{{0, 0, 1}, 2}, Plane{Eigen::Vector3f(0.4f, -0.3f, 1).normalized(), 1.5f},
                               Plane{Eigen::Vector3f(-0.6f, 0.2f, 0.9f).normalized(), 0.8f}}) {
        const RawDepth depth = registration.apply(measured(camera, plane), kMillimetres);
        ASSERT_EQ(depth.width(), color.intrinsics.width);
        int covered = 0;
        for (int v = 0; v < depth.height(); ++v) {
            for (int u = 0; u < depth.width(); ++u) {
                const float z =
                    z_on_plane(color.intrinsics, color.distortion, Eigen::Isometry3f::Identity(), plane, u, v);
                if (depth(u, v) == 0) continue;
                ++covered;
                if (!inside(depth, u, v)) continue;  // the outer half of the outermost pixels goes on at their depth
                // millimetres of the sensor, and straight lines between its pixels
                EXPECT_NEAR(static_cast<float>(depth(u, v)) / kMillimetres, z, 0.002f * z) << u << ", " << v;
            }
        }
        EXPECT_GT(covered, 40000) << "of 50440: the depth camera sees most of the colour image";
    }
}

TEST(DepthRegistration, NothingIsPutBetweenForegroundAndBackground) {
    const DepthCamera camera = depth_camera();
    RawDepth depth(128, 96, 3000);
    for (int v = 30; v < 70; ++v)
        for (int u = 40; u < 80; ++u) depth(u, v) = 1000;
    depth(100, 50) = 1200;  // one pixel alone
    const RawDepth registered = DepthRegistration(camera, color_camera()).apply(depth, kMillimetres);
    std::set<std::uint16_t> alone;
    for (const std::uint16_t d : registered) {
        EXPECT_TRUE(d == 0 || (d > 900 && d < 1100) || (d > 1150 && d < 1250) || (d > 2800 && d < 3300)) << d;
        if (d > 1150 && d < 1250) alone.insert(d);
    }
    EXPECT_EQ(alone.size(), 1u) << "a pixel alone has one depth";
}

TEST(DepthRegistration, WhatStandsInFrontHidesWhatIsBehind) {
    // A camera 20 cm to the right sees the wall behind a box that hides it from the colour camera.
    const Camera color{{100, 100, 49.5f, 49.5f, 100, 100}, kMillimetres, {}};
    DepthCamera camera{color.intrinsics, {}, Eigen::Isometry3f::Identity()};
    camera.T_color_depth.translation().x() = 0.2f;
    RawDepth depth(100, 100, 4000);
    for (int v = 20; v < 80; ++v)
        for (int u = 20; u < 40; ++u) depth(u, v) = 1000;  // x = -0.295 ... -0.105 m: columns 40 to 59 of colour
    const RawDepth registered = DepthRegistration(camera, color).apply(depth, kMillimetres);
    for (int u = 41; u < 59; ++u) EXPECT_EQ(registered(u, 50), 1000) << u;
    EXPECT_EQ(registered(65, 50), 4000) << "the wall beside it";
    EXPECT_EQ(registered(35, 50), 0) << "the wall that the box hides from the depth camera";
}

TEST(DepthRegistration, OfTheSameCameraInAnotherSizeIsInterpolation) {
    const Camera color{{848, 848, 479.5f, 359.5f, 960, 720}, kMillimetres, {}};
    CameraDescription description;
    description.camera = color;
    std::vector<std::string> warnings;
    const auto registration = registration_for(description, ImageSize{256, 192}, "phone", warnings);
    ASSERT_TRUE(registration);
    ASSERT_EQ(warnings.size(), 1u);
    EXPECT_NE(warnings[0].find("depth images are 256x192, colour is 960x720; they are taken to be of one camera"),
              std::string::npos)
        << warnings[0];
    const DepthCamera camera{resized(color.intrinsics, 256, 192), {}, Eigen::Isometry3f::Identity()};
    const Plane plane{Eigen::Vector3f(0.3f, 0.5f, 1).normalized(), 1.8f};
    const RawDepth depth = registration->apply(measured(camera, plane), kMillimetres);
    for (int v = 2; v < 718; ++v)
        for (int u = 2; u < 958; ++u) {
            const float z = kMillimetres * z_on_plane(color.intrinsics, {}, Eigen::Isometry3f::Identity(), plane, u, v);
            ASSERT_NEAR(depth(u, v), z, 2) << u << ", " << v;
        }
    EXPECT_NE(depth(0, 0), 0) << "up to the border";
    EXPECT_NE(depth(959, 719), 0);
}

TEST(DepthRegistration, SmallerColourThanDepthIsFine) {
    const Camera color{{100, 100, 49.5f, 49.5f, 100, 100}, kMillimetres, {}};
    const DepthCamera camera{resized(color.intrinsics, 400, 400), {}, Eigen::Isometry3f::Identity()};
    for (const std::uint16_t d : DepthRegistration(camera, color).apply(RawDepth(400, 400, 1234), kMillimetres))
        EXPECT_EQ(d, 1234);
}

TEST(DepthRegistration, WithoutMeasurementsThereIsNothing) {
    const DepthRegistration registration(depth_camera(), color_camera());
    for (const auto value : {std::uint16_t{0}, std::uint16_t{65535}})
        for (const std::uint16_t d : registration.apply(RawDepth(128, 96, value), kMillimetres)) EXPECT_EQ(d, 0);
    EXPECT_THROW((void)registration.apply(RawDepth(96, 128), kMillimetres), Error);
}

TEST(DepthRegistration, IsNeededOrNotOrImpossible) {
    CameraDescription description;
    description.camera = {{500, 500, 319.5f, 239.5f, 640, 480}, kMillimetres, {}};
    std::vector<std::string> warnings;
    EXPECT_FALSE(registration_for(description, ImageSize{640, 480}, "a", warnings));
    EXPECT_FALSE(registration_for(description, std::nullopt, "a", warnings));
    EXPECT_TRUE(warnings.empty());
    const std::string other = message_of<Error>([&] {
        (void)registration_for(description, ImageSize{512, 424}, "kinect", warnings);
    });
    EXPECT_NE(other.find("kinect: depth images are 512x424, colour is 640x480, and they are not of one camera; give "
                         "depth_fx"),
              std::string::npos)
        << other;
    description.depth = depth_camera();
    EXPECT_TRUE(registration_for(description, ImageSize{128, 96}, "a", warnings));
    EXPECT_NE(message_of<Error>([&] {
                  (void)registration_for(description, ImageSize{640, 480}, "a", warnings);
              }).find("the depth images are 640x480, but the camera says depth_width and depth_height 128x96"),
              std::string::npos);
    EXPECT_TRUE(warnings.empty());
}

}  // namespace
}  // namespace posefusion
