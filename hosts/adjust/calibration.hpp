#pragma once
#include <cstddef>

#include "hosts/adjust/bundle.hpp"

namespace posefusion {

/// When a calibration found by bundle adjustment is believed.
struct CalibrationConfig {
    static constexpr std::size_t kFewestKeyframes = 6, kFewestLandmarks = 100;
    /// A group of parameters, intrinsics, deformation or times, must deviate from what was given by so many standard
    /// deviations of what chance does: of the chi square distribution with as many degrees of freedom as the group has
    /// parameters.
    static constexpr double kLeastSigmas = 6;
    /// Every so manyth landmark takes no part, to compare calibrations by: it must fit better by this share of its
    /// cost.
    static constexpr std::size_t kHeldOut = 4;
    static constexpr double kLeastGain = 0.003;
    /// Larger errors, in units of their expected variance, mean that the images are not as assumed: a rolling shutter
    /// that was not found, depth that is not registered to colour. A camera that fits such images is not the true one.
    static constexpr double kMostVariance = 3;
    /// A calibration that differs by more than the given one can be wrong, standard deviations of BundleConfig, is a
    /// sign of the same.
    static constexpr double kMostSurprise = 4;
};

/// The calibration that keyframes speak for.
struct Calibration {
    CameraParameters given = CameraParameters::Zero();
    CameraParameters estimate = CameraParameters::Zero();         ///< all of it, certain or not
    CameraMatrix covariance = CameraMatrix::Zero();               ///< of the estimate
    CameraParameters believed = CameraParameters::Zero();         ///< as given where the estimate is not certain
    bool intrinsics = false, deformation = false, times = false;  ///< what of `believed` is not as given
    std::size_t keyframes = 0, landmarks = 0, observations = 0;
    double variance = 0;                       ///< of the errors, in units of what was expected
    double held_out_before = 0, held_out = 0;  ///< mean cost of the observations held out, as given and as estimated
    [[nodiscard]] bool found() const { return intrinsics || deformation || times; }
};

/// Estimates the calibration and decides what of it is certain.
/// @param bundle  of find_landmarks()  @param times  the times of its rows are uncertain, too
[[nodiscard]] Calibration calibrate(Bundle bundle, bool times = false);

}  // namespace posefusion
