#include "engine/loops/aligner.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "engine/slam/pose_conversion.hpp"

namespace posefusion {

using namespace vulkan;

namespace {

constexpr std::uint32_t kSamples = kLoopGridWidth * kLoopGridHeight;

/// No rotation-only pre-alignment: there is no previous image.
TrackingConfig tracking_of(const SlamConfig& config) {
    TrackingConfig tracking = config.tracking;
    tracking.so3_iterations = 0;
    return tracking;
}

double largest_sigma(const Eigen::Matrix3d& covariance) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance, Eigen::EigenvaluesOnly);
    return std::sqrt(std::max(0.0, solver.eigenvalues().maxCoeff()));
}

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

Aligner::Aligner(Context& context, const Intrinsics& camera, const SlamConfig& config)
    : context_(context),
      camera_(camera),
      config_(config.alignment),
      tracker_(context, camera, tracking_of(config)),
      model_(context, camera, "loop model"),
      model_color_(device_buffer<std::uint32_t>(context, pixels_at(camera, 0), "loop model colour")),
      wide_params_(host_buffer<gpu::Params>(context, 1, "rough alignment parameters")),
      fine_params_(host_buffer<gpu::Params>(context, 1, "alignment parameters")),
      host_record_(host_buffer<gpu::TrackingRecord>(context, 1, "host alignment record")),
      samples_(device_buffer<gpu::LoopSample>(context, kSamples, "loop samples")),
      host_samples_(host_buffer<gpu::LoopSample>(context, kSamples, "host loop samples")) {}

void Aligner::set_params(const gpu::Params& now, ModelPart part) {
    gpu::Params p = now;
    p.inactive_only = part == ModelPart::Inactive ? 1 : 0;
    if (part == ModelPart::Whole) p.active_since = 0;
    p.predict_confidence = p.stable_confidence;
    p.max_step_translation = p.max_step_rotation = AlignmentConfig::kMaxCorrection;
    p.min_inlier_ratio = 0;  // judged here, all of them
    p.max_icp_rmse = p.max_translation_sigma = p.max_rotation_sigma = std::numeric_limits<float>::max();
    fine_params_.host<gpu::Params>()[0] = p;
    p.icp_max_distance = AlignmentConfig::kWideDistance;
    p.icp_min_cosine = std::cos(AlignmentConfig::kWideAngleDeg * std::numbers::pi_v<float> / 180.0f);
    wide_params_.host<gpu::Params>()[0] = p;
}

void Aligner::enqueue(Sequence& sequence, const Preprocessing& frame, const PyramidBuilder& pyramids,
                      const SurfelMap& map) const {
    sequence.copy(host_record_, tracker_.record, sizeof(gpu::TrackingRecord));
    for (const Buffer* params : {&wide_params_, &fine_params_}) {
        map.enqueue_prediction(sequence, *params, tracker_.record, frame, false, model_, model_color_);
        pyramids.enqueue_model(sequence, *params, model_);
        tracker_.enqueue_frame(sequence, *params, frame.live, model_);
    }
    map.enqueue_loop_samples(sequence, fine_params_, tracker_.record, frame.live, model_, samples_);
    sequence.copy(tracker_.record, host_record_, sizeof(gpu::TrackingRecord));
    sequence.copy(samples_, host_samples_, samples_.bytes());
    sequence.finish();
}

Alignment Aligner::align(const gpu::Params& now, ModelPart part, float min_overlap,
                         const Eigen::Isometry3d& T_world_camera, const Preprocessing& frame,
                         const PyramidBuilder& pyramids, const SurfelMap& map) {
    set_params(now, part);
    auto& enqueue_now = host_record_.host<gpu::TrackingRecord>()[0];
    enqueue_now = {};
    enqueue_now.world_live = to_device(T_world_camera);
    enqueue_now.fusion_weight = 1;
    if (!align_sequence_) {
        align_sequence_ = std::make_unique<Sequence>(context_);
        enqueue(*align_sequence_, frame, pyramids, map);
    }
    align_sequence_->run();

    Alignment result;
    result.T_world_camera = from_device(enqueue_now.world_live);
    const auto samples = host_samples_.host<gpu::LoopSample>();
    result.samples.assign(samples.begin(), samples.end());
    judge(result, min_overlap, T_world_camera);
    return result;
}

void Aligner::judge(Alignment& alignment, float min_overlap, const Eigen::Isometry3d& proposed) const {
    const auto& record = host_record_.host<gpu::TrackingRecord>()[0];
    const auto live =
        std::count_if(alignment.samples.begin(), alignment.samples.end(), [](const auto& s) { return s.point.z > 0; });
    const auto both =
        std::count_if(alignment.samples.begin(), alignment.samples.end(), [](const auto& s) { return s.point.w > 0; });
    // the share of the whole image, so that a camera that sees little (a person in front of it) recognises nothing
    alignment.overlap = static_cast<float>(both) / static_cast<float>(kSamples);
    const float overlapping =
        live > 0 ? static_cast<float>(record.valid_pixels) * static_cast<float>(both) / static_cast<float>(live) : 0.0f;
    alignment.inlier_ratio = overlapping > 0 ? static_cast<float>(record.icp_inliers) / overlapping : 0.0f;
    alignment.icp_rmse_m = record.icp_rmse;
    alignment.photometric_rmse = record.photometric_rmse;
    alignment.correlation = correlation_of(alignment.samples);
    const Eigen::Matrix<double, 6, 6> covariance = covariance_of(record);
    const Eigen::Isometry3d correction = proposed.inverse() * alignment.T_world_camera;
    const auto reject = [&](bool condition, const char* reason) {
        if (condition && alignment.reason.empty()) alignment.reason = reason;
    };
    reject(alignment.overlap < min_overlap, "too little of the model in view");
    reject(record.failed != 0 || covariance.isZero(), "no pose found");
    reject(alignment.inlier_ratio < config_.min_inlier_ratio, "surfaces do not agree");
    reject(!(alignment.icp_rmse_m <= config_.max_icp_rmse), "surfaces agree too roughly");
    reject(record.photometric_inliers > 0 && !(alignment.photometric_rmse <= config_.max_photometric_rmse),
           "colours do not agree");
    reject(alignment.correlation < AlignmentConfig::kMinCorrelation, "it looks different");
    reject(largest_sigma(covariance.topLeftCorner<3, 3>()) > config_.max_translation_sigma ||
               largest_sigma(covariance.bottomRightCorner<3, 3>()) > config_.max_rotation_sigma,
           "the view does not fix the pose");
    reject(correction.translation().norm() > AlignmentConfig::kMaxCorrection ||
               Eigen::AngleAxisd(correction.linear()).angle() > AlignmentConfig::kMaxCorrection,
           "too far from the proposal");
    alignment.accepted = alignment.reason.empty();
}

void Aligner::reactivate(const gpu::Params& now, SurfelMap& map) {
    fine_params_.host<gpu::Params>()[0] = now;
    if (!reactivate_sequence_) {
        reactivate_sequence_ = std::make_unique<Sequence>(context_);
        map.enqueue_reactivation(*reactivate_sequence_, fine_params_, tracker_.record, model_.depth[0]);
        reactivate_sequence_->finish();
    }
    reactivate_sequence_->run();
}

}  // namespace posefusion
