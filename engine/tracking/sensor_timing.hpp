#pragma once
#include <Eigen/Core>
#include <span>

namespace posefusion {

/// When the pixels of an image were taken, seconds, as in ShutterConfig: (delay of depth, read-out time of depth,
/// read-out time of colour).
using SensorTimes = Eigen::Vector3d;

/// Estimates the times at which colour and depth are taken from how frames disagree: a row that was taken later shows
/// the scene from farther along the camera's motion. Only a moving camera says anything.
///
/// Each pair of frames gives a Gauss-Newton system in their relative pose and the times, which the Schur complement
/// reduces to the times; those of all pairs are added.
class SensorTiming {
public:
    struct Estimate {
        SensorTimes times = SensorTimes::Zero(), sigma = SensorTimes::Zero();  ///< with standard deviations
        int pairs = 0;
    };

    /// @param sums  TIMING_COLUMNS of track_reduce  @param used  the times that the images were corrected by
    void add(std::span<const float> sums, const SensorTimes& used);
    [[nodiscard]] Estimate estimate() const;

    // Standard deviations before anything was seen, seconds: of the times themselves, which are zero for a global
    // shutter and images taken at once, ...
    static constexpr double kReadoutSigma = 0.03, kDelaySigma = 0.02;
    /// ... and of what one pair says, however many pixels it has: motion is not constant between two frames, and what
    /// exposure or calibration do to one pair they do to all its pixels.
    static constexpr double kPairSigma = 0.01;
    /// Errors of neighbouring pixels are correlated: this many at half resolution count as one measurement
    /// (DeformationConfig::correlated_pixels at full resolution).
    static constexpr double kCorrelatedPixels = 25;

private:
    Eigen::Matrix3d information_ = Eigen::Matrix3d::Zero();
    SensorTimes weighted_ = SensorTimes::Zero();  // information * times
    int pairs_ = 0;
};

}  // namespace posefusion
