#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "engine/core/intrinsics.hpp"
#include "hosts/adjust/readout.hpp"
#include "hosts/io/depth_deformation.hpp"

/// Bundle adjustment (Triggs et al. 2000) of keyframes with depth: poses, points and the camera's calibration.
namespace posefusion {

/// What is known of a camera: fx, fy, cx, cy in pixels, then the nodes of the depth deformation in 1/m, then delay of
/// depth and read-out times of depth and colour in seconds (RowTimes).
inline constexpr int kIntrinsicParameters = 4, kDeformationParameters = static_cast<int>(DepthDeformation::kNodes),
                     kTimeParameters = 3;
inline constexpr int kCameraParameters = kIntrinsicParameters + kDeformationParameters + kTimeParameters;
using CameraParameters = Eigen::Matrix<double, kCameraParameters, 1>;
using CameraMatrix = Eigen::Matrix<double, kCameraParameters, kCameraParameters>;

[[nodiscard]] CameraParameters parameters_of(const Intrinsics& camera, const DepthDeformation& deformation = {},
                                             const RowTimes& times = {});
[[nodiscard]] Intrinsics intrinsics_of(const CameraParameters& parameters, int width, int height);
[[nodiscard]] DepthDeformation deformation_of(const CameraParameters& parameters);
[[nodiscard]] RowTimes times_of(const CameraParameters& parameters, double stamp_row);

// The parts of the parameters, or of other vectors of their kind.
template <class Vector>
[[nodiscard]] auto intrinsics_part(Vector&& v) {
    return v.template head<kIntrinsicParameters>();
}
template <class Vector>
[[nodiscard]] auto deformation_part(Vector&& v) {
    return v.template segment<kDeformationParameters>(kIntrinsicParameters);
}
template <class Vector>
[[nodiscard]] auto times_part(Vector&& v) {
    return v.template tail<kTimeParameters>();
}

/// A landmark seen in a keyframe.
struct Observation {
    std::uint32_t keyframe = 0, landmark = 0;
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
    double inverse_depth = 0;                         ///< as measured at that pixel, 1/m
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< of the measured inverse depth over the image, 1/m per pixel
    double pixel_sigma = 1, inverse_depth_sigma = 1;  ///< standard deviations
};

/// The motion between two keyframes, as it is known without landmarks.
struct PoseStep {
    std::uint32_t from = 0, to = 0;  ///< keyframes
    Eigen::Isometry3d T_to_from = Eigen::Isometry3d::Identity();
    double position_sigma = 0, rotation_sigma = 0;  ///< standard deviations per axis, metres and radians
};

/// Keyframes, the points that they see, and the camera.
struct Bundle {
    int width = 0, height = 0;                      ///< of the images
    double stamp_row = 0.5;                         ///< RowTimes::stamp_row
    std::vector<FrameReadout> readouts;             ///< of each keyframe; empty: all pixels are taken at the stamp
    std::vector<Eigen::Isometry3d> T_camera_world;  ///< of each keyframe; the first is the gauge and never changes
    std::vector<Eigen::Vector3d> landmarks;         ///< world
    std::vector<Observation> observations;          ///< ascending in `landmark`
    std::vector<PoseStep> steps;                    ///< hold keyframes together that share few landmarks
    CameraParameters camera = CameraParameters::Zero();
};

/// What is believed before anything was seen, and how errors count.
struct BundleConfig {
    // What of the camera is unknown; the rest is as given.
    bool intrinsics = true, deformation = true, times = false;
    [[nodiscard]] bool calibrate() const { return intrinsics || deformation || times; }
    // Standard deviations of the given calibration. That of a camera of the same kind is right to about a per cent.
    static constexpr double kFocalSigma = 0.01;   ///< of the focal length
    static constexpr double kCentreSigma = 0.01;  ///< of the image's width
    static constexpr double kNodeSigma = 0.01;    ///< 1/m: 2 cm at 1.4 m, more than any sensor off the shelf
    static constexpr double kBendSigma = 0.003;   ///< 1/m, of second differences of neighbouring nodes: it is smooth
    static constexpr double kDelaySigma = 0.002, kReadoutSigma = 0.003;  ///< seconds, of times that are known roughly
    static constexpr double kCauchy = 2;  ///< errors beyond this count less, standard deviations
    static constexpr int kSteps = 30;
    static constexpr double kConverged = 1e-5;  ///< relative decrease of the cost
};

struct BundleResult {
    double cost = 0;      ///< half the sum of the robust squares, those of the priors included
    double variance = 1;  ///< of the errors, in units of their assumed variance; robust
    int steps = 0;
    /// Of the camera, all else being unknown as well; in units of the errors as they are. Zero without `calibrate`.
    CameraMatrix covariance = CameraMatrix::Zero();
};

/// Levenberg-Marquardt with Cauchy weights; the Schur complement takes the landmarks out of each system. The same
/// result for the same input. Changes poses, landmarks and, with `calibrate`, the camera.
/// @param given  the calibration that the priors are about
BundleResult adjust(Bundle& bundle, const CameraParameters& given, const BundleConfig& config);

/// Half the sum of the robust squares of the observations, with every landmark where it fits best.
[[nodiscard]] double cost_of(Bundle bundle);

/// cost_of() per observation.
[[nodiscard]] double mean_cost_of(const Bundle& bundle);

/// The observations of every `every`-th landmark, to compare solutions by, or those of the others.
[[nodiscard]] Bundle part_of(const Bundle& bundle, std::size_t every, bool held_out);

/// Where a frame is without its landmarks.
struct ExpectedPose {
    Eigen::Isometry3d T_camera_world = Eigen::Isometry3d::Identity();
    double position_sigma = 0, rotation_sigma = 0;  ///< standard deviations per axis, metres and radians
};

/// The pose of one more frame, from landmarks at known places. @param seen  observations in that frame, whatever
/// keyframe they name  @param camera  of the bundle: calibration, size of the images  @param readout  of the frame;
/// ignored where the bundle has none; where a side of it is unknown, its rows tell the motion there, too
/// @return T_camera_world; nullopt: they do not determine it
[[nodiscard]] std::optional<Eigen::Isometry3d> fit_pose(const Bundle& bundle, const std::vector<Observation>& seen,
                                                        const FrameReadout& readout, const ExpectedPose& expected);

/// Standard deviations of the given calibration, BundleConfig's, as parameters. @param width  of the image
[[nodiscard]] CameraParameters prior_sigmas(const CameraParameters& given, int width);

/// Error of an observation: of u, v and the inverse depth, in standard deviations; nothing behind the camera.
struct ObservationError {
    bool valid = false;
    Eigen::Vector3d error = Eigen::Vector3d::Zero();
    Eigen::Matrix3d by_point = Eigen::Matrix3d::Zero();  ///< derivative by the point in the camera at the stamp
    Eigen::Matrix<double, 3, kIntrinsicParameters> by_intrinsics =
        Eigen::Matrix<double, 3, kIntrinsicParameters>::Zero();
    DeformationCell cell;       ///< derivative of the third by the nodes of the deformation: ...
    double by_deformation = 0;  ///< ... this times the weight of each
    Eigen::Matrix<double, 3, kTimeParameters> by_times = Eigen::Matrix<double, 3, kTimeParameters>::Zero();
};
/// @param point  in the camera at the stamp  @param bundle  camera, size of the images and motion of the keyframe
[[nodiscard]] ObservationError error_of(const Observation& observation, const Eigen::Vector3d& point,
                                        const Bundle& bundle);

}  // namespace posefusion
