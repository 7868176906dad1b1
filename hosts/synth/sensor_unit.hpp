#pragma once
#include <Eigen/Core>
#include <cstdint>

#include "hosts/io/camera_file.hpp"
#include "hosts/synth/random.hpp"
#include "hosts/synth/sensor_model.hpp"

namespace posefusion::synth {

/// Smooth error of depth: 1 / measured = 1 / true - c(u, v), as BAD SLAM (Schoeps et al., CVPR 2019, section 3.3) has
/// it without its attenuation; c = corner (r^2 - still_radius^2) + tilt x. r: distance from the principal point, 1 in
/// the corner of an image that is centred; x: the same to the right, 1 at the edge. To first order measured depth is
/// off by c z^2.
struct DepthDistortion {
    float corner = 0, tilt = 0;  ///< 1/metre
    float still_radius2 = 0;     ///< r^2 at which the first term vanishes

    [[nodiscard]] float at(float u, float v, const Intrinsics& camera) const;
    [[nodiscard]] float distorted(float z, float u, float v, const Intrinsics& camera) const {
        return z / (1 - at(u, v, camera) * z);
    }
};

/// One camera of a kind, with errors of its own: its optics, its calibration and its clock.
class SensorUnit {
public:
    /// @param nominal  the camera without errors  @param seed  decides the errors
    SensorUnit(const SensorModel& model, const Intrinsics& nominal, float depth_scale, std::uint64_t seed);

    [[nodiscard]] const SensorModel& model() const { return model_; }
    [[nodiscard]] const Camera& camera() const { return camera_; }            ///< as it is
    [[nodiscard]] const Camera& calibration() const { return calibration_; }  ///< as its maker believes
    [[nodiscard]] const DepthDistortion& depth_distortion() const { return depth_distortion_; }

    /// The point at depth 1 that is seen at a position of the image.
    [[nodiscard]] Eigen::Vector3f ray(float u, float v) const;
    /// Where a point in front of the camera is seen.
    [[nodiscard]] Eigen::Vector2f project(const Eigen::Vector3f& point) const;
    /// Light that reaches the sensor, 1 in the middle.
    [[nodiscard]] float vignetting(float u, float v) const;

    /// By how much the stamp of depth is later than that of colour, seconds. @param t  seconds
    [[nodiscard]] double stamped_delay(double t) const;
    /// When a row is read, seconds after the stamp of colour. @param t  of that stamp
    [[nodiscard]] double color_time(int row) const;
    [[nodiscard]] double depth_time(int row, double t) const;

private:
    [[nodiscard]] double row_time(int row, float readout_ms) const;
    SensorModel model_;
    Camera camera_, calibration_;
    DepthDistortion depth_distortion_;
    SmoothNoise wander_;
};

}  // namespace posefusion::synth
