#pragma once
#include <Eigen/Core>

#include "engine/core/intrinsics.hpp"

/// From points in camera coordinates (metres) to pixels and back. Pixel positions are as Intrinsics says: whole numbers
/// are centres of pixels. In the shaders: include/geometry.glsl.
namespace posefusion {

/// The pixel position of a point; z must not be 0. A point behind the camera is projected through the centre
/// (mirrored).
template <class Point>
[[nodiscard]] Eigen::Vector2<typename Point::Scalar> project(const Eigen::MatrixBase<Point>& point,
                                                             const Intrinsics& camera) {
    const Eigen::Vector3<typename Point::Scalar> p = point;
    return {p.x() / p.z() * camera.fx + camera.cx, p.y() / p.z() * camera.fy + camera.cy};
}

/// Whether a position lies within the rectangle of the image's pixel centres.
template <class Position>
[[nodiscard]] bool in_image(const Eigen::MatrixBase<Position>& pixel, const Intrinsics& camera) {
    return pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() <= static_cast<float>(camera.width - 1) &&
           pixel.y() <= static_cast<float>(camera.height - 1);
}

/// The point at depth 1 that is seen at (u, v).
[[nodiscard]] inline Eigen::Vector3f pixel_ray(float u, float v, const Intrinsics& camera) {
    return {(u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy, 1};
}

/// The point at depth z (along the optical axis, metres) that is seen at (u, v).
[[nodiscard]] inline Eigen::Vector3f back_project(float u, float v, float z, const Intrinsics& camera) {
    return pixel_ray(u, v, camera) * z;
}

}  // namespace posefusion
