#include "hosts/adjust/patch_alignment.hpp"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "engine/core/pinhole.hpp"

namespace posefusion {
namespace {

constexpr Intrinsics kCamera{300, 300, 159.5f, 119.5f, 320, 240};

/// A textured wall in the world's plane n x = d, in a light of that strength.
ColorImage wall_seen_from(const Eigen::Isometry3d& T_world_camera, double light) {
    const Eigen::Vector3d n = Eigen::Vector3d(0.3, 0.1, 1).normalized();
    constexpr double kDistance = 1.8;
    ColorImage image(kCamera.width, kCamera.height);
    for (int v = 0; v < image.height(); ++v) {
        for (int u = 0; u < image.width(); ++u) {
            const Eigen::Vector3d ray = T_world_camera.linear() *
                                        pixel_ray(static_cast<float>(u), static_cast<float>(v), kCamera).cast<double>();
            const Eigen::Vector3d origin = T_world_camera.translation();
            const Eigen::Vector3d p = origin + ray * ((kDistance - n.dot(origin)) / n.dot(ray));
            const double texture = 90 + 30 * std::sin(31 * p.x() + 9 * p.y()) + 30 * std::sin(27 * p.y() - 14 * p.x());
            const auto grey = static_cast<std::uint8_t>(std::lround(light * texture));
            image(u, v) = {grey, grey, grey};
        }
    }
    return image;
}

/// What a camera elsewhere sees of it.
PlaceThere seen_from(const Eigen::Isometry3d& T_there_here) {
    return [T_there_here](const Eigen::Vector2d& pixel, double inverse_depth) -> std::optional<Eigen::Vector2d> {
        const Eigen::Vector3d ray((pixel.x() - kCamera.cx) / kCamera.fx, (pixel.y() - kCamera.cy) / kCamera.fy, 1);
        const Eigen::Vector3d p = T_there_here * (ray / inverse_depth);
        return p.z() > 0 ? std::optional(project(p, kCamera)) : std::nullopt;
    };
}

TEST(PatchAlignment, FindsAPatchOfASlantedWallWhateverTheLight) {
    Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
    T.translation() << 0.12, -0.05, 0.15;
    T.linear() = (Eigen::AngleAxisd(0.15, Eigen::Vector3d::UnitZ()) * Eigen::AngleAxisd(0.1, Eigen::Vector3d::UnitY()))
                     .toRotationMatrix();
    const IntensityPyramid here = intensity_pyramid(wall_seen_from(Eigen::Isometry3d::Identity(), 1)),
                           there = intensity_pyramid(wall_seen_from(T, 1.3));
    const Eigen::Vector3d n = Eigen::Vector3d(0.3, 0.1, 1).normalized() / 1.8;  // inverse depth of pixel (u, v): n ray
    Eigen::Isometry3d known = T.inverse();
    known.translation().x() += 0.02;  // three pixels of error
    for (const Eigen::Vector2d& pixel :
         {Eigen::Vector2d(120, 80), Eigen::Vector2d(200, 150), Eigen::Vector2d(170, 60)}) {
        const Eigen::Vector3d ray((pixel.x() - kCamera.cx) / kCamera.fx, (pixel.y() - kCamera.cy) / kCamera.fy, 1);
        const SurfacePatch patch{pixel, n.dot(ray), {n.x() / kCamera.fx, n.y() / kCamera.fy}};
        const auto found = find_patch(here, patch, there, seen_from(known));
        ASSERT_TRUE(found);
        const Eigen::Vector2d truth = project(T.inverse() * (ray / patch.inverse_depth), kCamera);
        EXPECT_LT((found->pixel - truth).norm(), 0.05) << pixel.transpose();
        EXPECT_LT(found->sigma, 0.1);
    }
}

TEST(PatchAlignment, WhatLooksDifferentIsNotFound) {
    const IntensityPyramid here = intensity_pyramid(wall_seen_from(Eigen::Isometry3d::Identity(), 1));
    ColorImage noise(kCamera.width, kCamera.height);
    std::uint32_t state = 1;
    for (Rgb8& pixel : noise) {
        state = state * 1664525u + 1013904223u;  // Numerical Recipes
        pixel.r = pixel.g = pixel.b = static_cast<std::uint8_t>(state >> 24);
    }
    const SurfacePatch patch{{150, 120}, 0.5, {0, 0}};
    EXPECT_FALSE(find_patch(here, patch, intensity_pyramid(noise), seen_from(Eigen::Isometry3d::Identity())));
    Eigen::Isometry3d away = Eigen::Isometry3d::Identity();
    away.translation().x() = 5;
    EXPECT_FALSE(find_patch(here, patch, here, seen_from(away))) << "out of view";
}

}  // namespace
}  // namespace posefusion
