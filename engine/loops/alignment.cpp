#include "engine/loops/alignment.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "engine/tracking/information.hpp"
#include "engine/vulkan/pose_conversion.hpp"

namespace posefusion {
namespace {

/// The largest standard deviation and its direction.
struct LargestSigma {
    explicit LargestSigma(const Eigen::Matrix3d& covariance) {
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);  // in ascending order
        sigma = std::sqrt(std::max(0.0, solver.eigenvalues()(2)));
        direction = solver.eigenvectors().col(2);
    }
    double sigma = 0;
    Eigen::Vector3d direction;
};

}  // namespace

float correlation_of(std::span<const gpu::LoopSample> samples) {
    constexpr double kLeastContrast = 0.02;  // standard deviation of the intensity, about that of noise and vignetting
    constexpr int kLeastSamples = 30;
    double n = 0, live = 0, model = 0, live2 = 0, model2 = 0, both = 0;
    for (const auto& sample : samples) {
        if (!sample.valid || sample.live_intensity < 0 || sample.model_intensity < 0) continue;
        const auto a = static_cast<double>(sample.live_intensity), b = static_cast<double>(sample.model_intensity);
        n += 1, live += a, model += b, live2 += a * a, model2 += b * b, both += a * b;
    }
    if (n < kLeastSamples) return 1;
    const double variance_live = live2 / n - live / n * live / n, variance_model = model2 / n - model / n * model / n;
    if (std::min(variance_live, variance_model) < kLeastContrast * kLeastContrast) return 1;
    return static_cast<float>((both / n - live / n * model / n) / std::sqrt(variance_live * variance_model));
}

Alignment judge(const gpu::TrackingRecord& record, std::span<const gpu::LoopSample> samples,
                const Eigen::Isometry3d& proposed, float min_overlap, const AlignmentConfig& config) {
    Alignment alignment;
    alignment.T_world_camera = from_device(record.world_live);
    alignment.samples.assign(samples.begin(), samples.end());
    const auto live = std::count_if(samples.begin(), samples.end(), [](const auto& s) { return s.point.z > 0; });
    const auto both = std::count_if(samples.begin(), samples.end(), [](const auto& s) { return s.point.w > 0; });
    // the share of the whole image, so that a camera that sees little (a person in front of it) recognises nothing
    alignment.overlap = static_cast<float>(both) / static_cast<float>(samples.size());
    const float overlapping =
        live > 0 ? static_cast<float>(record.valid_pixels) * static_cast<float>(both) / static_cast<float>(live) : 0.0f;
    alignment.inlier_ratio = overlapping > 0 ? static_cast<float>(record.icp_inliers) / overlapping : 0.0f;
    alignment.icp_rmse_m = record.icp_rmse;
    alignment.photometric_rmse = record.photometric_rmse;
    if (record.photometric_inliers > 0) alignment.gain = record.photometric_gain;
    alignment.correlation = correlation_of(samples);
    const Matrix6d covariance = covariance_of(record);
    const LargestSigma translation(covariance.topLeftCorner<3, 3>()), rotation(covariance.bottomRightCorner<3, 3>());
    alignment.least_certain = translation.direction;
    const Eigen::Isometry3d correction = proposed.inverse() * alignment.T_world_camera;
    const auto reject = [&](bool condition, const char* reason) {
        if (condition && alignment.reason.empty()) alignment.reason = reason;
    };
    reject(alignment.overlap < min_overlap, "too little of the model in view");
    reject(record.failed != 0 || covariance.isZero(), "no pose found");
    reject(alignment.inlier_ratio < config.min_inlier_ratio, "surfaces do not agree");
    reject(!(alignment.icp_rmse_m <= config.max_icp_rmse), "surfaces agree too roughly");
    reject(record.photometric_inliers > 0 && !(alignment.photometric_rmse <= config.max_photometric_rmse),
           "colours do not agree");
    reject(alignment.correlation < AlignmentConfig::kMinCorrelation, "it looks different");
    reject(translation.sigma > AlignmentConfig::kMaxTranslationSigma ||
               rotation.sigma > AlignmentConfig::kMaxRotationSigma,
           "the view does not fix the pose");
    reject(correction.translation().norm() > AlignmentConfig::kMaxCorrection ||
               Eigen::AngleAxisd(correction.linear()).angle() > AlignmentConfig::kMaxCorrection,
           "too far from the proposal");
    alignment.accepted = alignment.reason.empty();
    return alignment;
}

std::optional<std::size_t> most_alike(std::span<const Alignment> places) {
    constexpr float kClearly = 2;  // times as much of the intensities' variance is left unexplained elsewhere
    if (places.empty()) return std::nullopt;
    const auto unexplained = [](const Alignment& place) { return 1 - place.correlation; };
    const auto best = std::min_element(places.begin(), places.end(), [&](const Alignment& a, const Alignment& b) {
        return unexplained(a) < unexplained(b);
    });
    for (auto other = places.begin(); other != places.end(); ++other) {
        if (other != best && unexplained(*other) <= kClearly * unexplained(*best)) return std::nullopt;
    }
    return static_cast<std::size_t>(best - places.begin());
}

LoopEvent event_of(LoopKind kind, std::uint32_t frame, const Alignment& alignment) {
    LoopEvent event;
    event.kind = kind;
    event.frame = frame;
    event.accepted = alignment.accepted;
    event.reason = alignment.reason;
    event.overlap = alignment.overlap;
    event.inlier_ratio = alignment.inlier_ratio;
    event.icp_rmse_m = alignment.icp_rmse_m;
    event.photometric_rmse = alignment.photometric_rmse;
    event.correlation = alignment.correlation;
    return event;
}

}  // namespace posefusion
