#include "hosts/synth/sensor_unit.hpp"

#include <cmath>

#include "engine/core/pinhole.hpp"

namespace posefusion::synth {
namespace {

constexpr double kSeconds = 1e-3;                       ///< of a millisecond
constexpr double kWanderHz = 1.0 / 20;                  ///< of the streams against each other
constexpr float kStillLeast = 0.2f, kStillMost = 0.5f;  ///< DepthDistortion::still_radius2

/// Position relative to the principal point: (1, 1) in the corner of an image that is centred.
Eigen::Vector2f from_center(float u, float v, const Intrinsics& camera) {
    return {(u - camera.cx) / (0.5f * static_cast<float>(camera.width)),
            (v - camera.cy) / (0.5f * static_cast<float>(camera.height))};
}

/// Distance from the principal point, squared: 1 in the corner.
float radius2(float u, float v, const Intrinsics& camera) {
    const float half_width = 0.5f * static_cast<float>(camera.width),
                half_height = 0.5f * static_cast<float>(camera.height);
    const float du = u - camera.cx, dv = v - camera.cy;
    return (du * du + dv * dv) / (half_width * half_width + half_height * half_height);
}

Camera miscalibrated(Camera camera, const CalibrationTolerance& tolerance, Rng& rng) {
    Intrinsics& k = camera.intrinsics;
    const float pixels = tolerance.principal * static_cast<float>(k.width) / kReferenceWidth;
    k.fx *= 1 + rng.uniform(-tolerance.focal, tolerance.focal);
    k.fy *= 1 + rng.uniform(-tolerance.focal, tolerance.focal);
    k.cx += rng.uniform(-pixels, pixels);
    k.cy += rng.uniform(-pixels, pixels);
    const float lens = 1 + rng.uniform(-tolerance.lens, tolerance.lens);
    for (float& coefficient : camera.distortion) coefficient *= lens;
    return camera;
}

DepthDistortion distortion_of(const DistortionTolerance& tolerance, Rng& rng) {
    DepthDistortion d;
    const float sign = rng.chance(0.5f) ? 1.0f : -1.0f;
    d.corner = sign * rng.uniform(tolerance.corner_least, tolerance.corner_most);
    d.still_radius2 = rng.uniform(kStillLeast, kStillMost);
    d.tilt = rng.uniform(-tolerance.tilt, tolerance.tilt);
    return d;
}

}  // namespace

float DepthDistortion::at(float u, float v, const Intrinsics& camera) const {
    return corner * (radius2(u, v, camera) - still_radius2) + tilt * from_center(u, v, camera).x();
}

SensorUnit::SensorUnit(const SensorModel& model, const Intrinsics& nominal, float depth_scale, std::uint64_t seed)
    : model_(model), camera_{nominal, depth_scale, model.lens}, wander_(hash(seed, 3), kWanderHz) {
    Rng calibration(hash(seed, 1)), distortion(hash(seed, 2));
    calibration_ = miscalibrated(camera_, model.calibration, calibration);
    depth_distortion_ = distortion_of(model.depth_distortion, distortion);
}

Eigen::Vector3f SensorUnit::ray(float u, float v) const {
    const Eigen::Vector3f straight = pixel_ray(u, v, camera_.intrinsics);
    if (!camera_.distorted()) return straight;
    const PlanePoint ideal = undistort({straight.x(), straight.y()}, camera_.distortion);
    return {ideal.x, ideal.y, 1};
}

Eigen::Vector2f SensorUnit::project(const Eigen::Vector3f& point) const {
    if (!camera_.distorted()) return posefusion::project(point, camera_.intrinsics);
    const PlanePoint seen = distort({point.x() / point.z(), point.y() / point.z()}, camera_.distortion);
    return posefusion::project(Eigen::Vector3f(seen.x, seen.y, 1), camera_.intrinsics);
}

float SensorUnit::vignetting(float u, float v) const {
    return std::exp2(-model_.exposure.vignetting_ev * radius2(u, v, camera_.intrinsics));
}

double SensorUnit::stamped_delay(double t) const {
    return kSeconds *
           (static_cast<double>(model_.stamped_delay_ms) + static_cast<double>(model_.stamped_wander_ms) * wander_(t));
}

double SensorUnit::row_time(int row, float readout_ms) const {
    const double share = (row + 0.5) / camera_.intrinsics.height - static_cast<double>(model_.shutter.stamp_row);
    return kSeconds * static_cast<double>(readout_ms) * share;
}

double SensorUnit::color_time(int row) const { return row_time(row, model_.shutter.color_readout_ms); }

double SensorUnit::depth_time(int row, double t) const {
    return stamped_delay(t) + kSeconds * static_cast<double>(model_.shutter.depth_delay_ms) +
           row_time(row, model_.shutter.depth_readout_ms);
}

}  // namespace posefusion::synth
