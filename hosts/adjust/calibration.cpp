#include "hosts/adjust/calibration.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace posefusion {
namespace {

using Eigen::Index;

/// Mean cost of observations that had no part in a solution.
double mean_cost(Bundle observed, const Bundle& solution) {
    observed.T_camera_world = solution.T_camera_world;
    observed.camera = solution.camera;
    return mean_cost_of(observed);
}

/// Whether a group of parameters deviates by more than chance.
bool is_significant(const Calibration& c, Index first, Index n) {
    const Eigen::VectorXd change = (c.estimate - c.given).segment(first, n);
    const double square = change.dot(c.covariance.block(first, first, n, n).ldlt().solve(change));
    const double freedom = static_cast<double>(n);
    return square > freedom + CalibrationConfig::kLeastSigmas * std::sqrt(2 * freedom);
}

}  // namespace

Calibration calibrate(Bundle bundle, bool times) {
    Calibration c;
    c.given = c.estimate = c.believed = bundle.camera;
    c.keyframes = bundle.T_camera_world.size();
    c.landmarks = bundle.landmarks.size();
    c.observations = bundle.observations.size();
    const CameraParameters sigmas = prior_sigmas(c.given, bundle.width);
    c.covariance = sigmas.cwiseAbs2().asDiagonal();
    if (c.keyframes < CalibrationConfig::kFewestKeyframes || c.landmarks < CalibrationConfig::kFewestLandmarks)
        return c;

    const Bundle held_out = part_of(bundle, CalibrationConfig::kHeldOut, true);
    Bundle trained = part_of(bundle, CalibrationConfig::kHeldOut, false);
    const BundleConfig everything{.times = times};
    adjust(trained, c.given, {.intrinsics = false, .deformation = false});
    c.held_out_before = mean_cost(held_out, trained);
    adjust(trained, c.given, everything);
    c.held_out = mean_cost(held_out, trained);

    bundle.T_camera_world = trained.T_camera_world;
    bundle.camera = trained.camera;
    const BundleResult all = adjust(bundle, c.given, everything);
    c.estimate = bundle.camera;
    c.covariance = all.covariance;
    c.variance = all.variance;
    const bool plausible =
        ((c.estimate - c.given).cwiseAbs().array() < CalibrationConfig::kMostSurprise * sigmas.array()).all();
    if (c.variance > CalibrationConfig::kMostVariance || !plausible ||
        !(c.held_out < (1 - CalibrationConfig::kLeastGain) * c.held_out_before))
        return c;
    c.intrinsics = is_significant(c, 0, kIntrinsicParameters);
    c.deformation = is_significant(c, kIntrinsicParameters, kDeformationParameters);
    c.times = times && is_significant(c, kCameraParameters - kTimeParameters, kTimeParameters);
    if (!c.found()) return c;
    if (!c.intrinsics || !c.deformation || c.times != times) {
        // what is not certain stays as given, and the rest is found again
        bundle.camera = c.given;
        adjust(bundle, c.given, {.intrinsics = c.intrinsics, .deformation = c.deformation, .times = c.times});
    }
    if (c.intrinsics) intrinsics_part(c.believed) = intrinsics_part(bundle.camera);
    if (c.deformation) deformation_part(c.believed) = deformation_part(bundle.camera);
    if (c.times) times_part(c.believed) = times_part(bundle.camera);
    return c;
}

}  // namespace posefusion
