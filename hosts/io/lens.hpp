#pragma once
#include <array>
#include <string>

/// Lens distortion.
namespace posefusion {

/// k1 k2 p1 p2 k3 k4 k5 k6 of OpenCV's rational model; with k4 to k6 = 0 it is Brown's. All 0: no distortion.
using LensCoefficients = std::array<float, 8>;

/// A point on the plane z = 1 of a camera.
struct PlanePoint {
    float x, y;
};

/// The distorted position of a point that an ideal lens would project to `ideal`:
/// https://docs.opencv.org/4.x/d9/d0c/group__calib3d.html
[[nodiscard]] PlanePoint distort(PlanePoint ideal, const LensCoefficients& lens);

/// The inverse, by fixed-point iteration as in OpenCV's undistortPoints.
[[nodiscard]] PlanePoint undistort(PlanePoint distorted, const LensCoefficients& lens);

/// Whether `model` names an unsupported lens model: fisheye, equidistant, Kannala-Brandt, omnidirectional.
[[nodiscard]] bool is_wide_angle_model(std::string model);

/// The message about it.
inline constexpr const char* kWideAngleAdvice =
    "such lenses are not undone here; undistort the images beforehand (OpenCV: cv::fisheye::undistortImage) and give "
    "the camera of the result";

}  // namespace posefusion
