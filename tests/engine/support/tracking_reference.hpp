#pragma once
#include <array>
#include <functional>
#include <vector>

#include "tests/engine/support/kernel_harness.hpp"
#include "tests/engine/support/reference.hpp"

/// The tracking kernels' sums over an image, on the CPU, with Jacobians by numeric differentiation of the residuals.
namespace posefusion::test {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// What track_reduce reads at one level.
struct ImagePair {
    std::vector<gpu::vec4> live_geometry, live_photometric, model_geometry, model_photometric;
};

constexpr float kGain = 1.02f;  ///< photometric_gain of tracking_record()

/// Two views of a wavy, textured surface, `T` apart in `noise` metres of depth noise; holes, outliers, unknown
/// intensities.
[[nodiscard]] ImagePair wavy_pair(const gpu::Params& params, int level, unsigned seed);
/// The same with intensities that are linear in the pixel, so that every estimate of the gradient is exact, the live
/// ones in another exposure: kGain times as bright as the live image is the model.
[[nodiscard]] ImagePair ramp_pair(const gpu::Params& params, int level, unsigned seed);
/// (intensity, gradient) of intensities: central differences, -1 at the border and next to unknown pixels.
[[nodiscard]] std::vector<gpu::vec4> photometric_of(const Camera& camera, const std::vector<double>& intensity);

struct TrackSums {
    Matrix6d H = Matrix6d::Zero();
    Vector6d g = Vector6d::Zero();
    Vector6d g_scale = Vector6d::Zero();  ///< sum of |w J r|: what rounding of g is measured in
    double icp_abs = 0, icp_count = 0, icp_squares = 0;
    double photometric_abs = 0, photometric_count = 0, photometric_squares = 0;
    double live_intensity = 0, model_intensity = 0;  ///< sums by the robust weights
    double live_count = 0;
};

/// How the residuals depend on the times of the rows (track_reduce with TIMING): delay of depth, read-out times of
/// depth and of colour.
struct TimingSums {
    Eigen::Matrix<double, 6, 3> both = Eigen::Matrix<double, 6, 3>::Zero();  ///< with the pose
    Eigen::Matrix3d times = Eigen::Matrix3d::Zero();
    Vector3d gradient = Vector3d::Zero(), gradient_scale = Vector3d::Zero();
};

/// How the residuals depend on the offset of the turn and on its acceleration (track_reduce with TURN).
struct TurnSums {
    Matrix6d both = Matrix6d::Zero();  ///< rows: pose; columns: turn, acceleration
    Matrix6d turn = Matrix6d::Zero();
    Vector6d gradient = Vector6d::Zero(), gradient_scale = Vector6d::Zero();
};

/// How the photometric reference differentiates.
enum class Shade {
    Linearised,  ///< intensity around the pixel from the kernel's own mean gradient
    Image        ///< the bilinear model image itself
};

[[nodiscard]] TrackSums reference_track_sums(const gpu::Params& params, int level, const gpu::TrackingRecord& record,
                                             const ImagePair& images, Shade shade, unsigned step = 1,
                                             bool rolling = false, TimingSums* timing = nullptr,
                                             TurnSums* turn = nullptr);
/// @param step  2 takes every second pixel, as on a chequerboard
[[nodiscard]] TrackSums kernel_track_sums(const gpu::Params& params, int level, const gpu::TrackingRecord& record,
                                          const ImagePair& images, unsigned step = 1, bool rolling = false,
                                          TimingSums* timing = nullptr, TurnSums* turn = nullptr);

struct So3Sums {
    Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
    Vector3d g = Vector3d::Zero(), g_scale = Vector3d::Zero();
    double squares = 0, count = 0;
};
[[nodiscard]] So3Sums reference_so3_sums(const gpu::Params& params, int level, const gpu::TrackingRecord& record,
                                         const std::vector<gpu::vec4>& live, const std::vector<gpu::vec4>& previous);
[[nodiscard]] So3Sums kernel_so3_sums(const gpu::Params& params, int level, const gpu::TrackingRecord& record,
                                      const std::vector<gpu::vec4>& live, const std::vector<gpu::vec4>& previous);

/// A record as before the first iteration of a level.
[[nodiscard]] gpu::TrackingRecord tracking_record(const Isometry3d& model_live);

}  // namespace posefusion::test
