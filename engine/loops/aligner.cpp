#include "engine/loops/aligner.hpp"

#include <cmath>
#include <limits>

#include "engine/core/angle.hpp"
#include "engine/vulkan/pose_conversion.hpp"

namespace posefusion {

using namespace vulkan;

namespace {

constexpr std::uint32_t kSamples = gpu::LOOP_GRID_WIDTH * gpu::LOOP_GRID_HEIGHT;
constexpr int kQuarter = 2;  // level at which intensities are compared

/// No rotation-only pre-alignment: there is no previous image.
TrackingConfig without_so3(TrackingConfig tracking) {
    tracking.so3_iterations = 0;
    return tracking;
}

}  // namespace

Aligner::Aligner(Context& context, const Intrinsics& camera, const AlignmentConfig& config,
                 const TrackingConfig& tracking)
    : context_(context),
      config_(config),
      tracker_(context, camera, without_so3(tracking)),
      model_(context, camera, "loop model"),
      model_color_(device_buffer<std::uint32_t>(context, pixels_at(camera, 0), "loop model colour")),
      wide_params_(host_buffer<gpu::Params>(context, 1, "rough alignment parameters")),
      fine_params_(host_buffer<gpu::Params>(context, 1, "alignment parameters")),
      host_record_(host_buffer<gpu::TrackingRecord>(context, 1, "host alignment record")),
      samples_(device_buffer<gpu::LoopSample>(context, kSamples, "loop samples")),
      host_samples_(host_buffer<gpu::LoopSample>(context, kSamples, "host loop samples")),
      loop_samples_(context, "loops/loop_samples", {{"CELL_STRIDE", cell_stride(context)}}),
      reactivate_(context, "loops/reactivate") {}

void Aligner::set_params(const gpu::Params& now, ModelPart part) {
    gpu::Params p = now;
    p.inactive_only = part == ModelPart::Inactive ? 1 : 0;
    if (part == ModelPart::Whole) p.active_since = 0;
    p.predict_confidence = p.stable_confidence;
    p.max_step_translation = p.max_step_rotation = AlignmentConfig::kMaxCorrection;
    p.steady_floor = 0;      // there is no motion that goes on
    p.min_inlier_ratio = 0;  // judge() decides about all of these
    p.max_icp_rmse = p.max_translation_sigma = p.max_rotation_sigma = std::numeric_limits<float>::max();
    fine_params_.host<gpu::Params>()[0] = p;
    p.icp_max_distance = AlignmentConfig::kWideDistance;
    p.icp_min_cosine = std::cos(radians(AlignmentConfig::kWideAngleDeg));
    wide_params_.host<gpu::Params>()[0] = p;
}

void Aligner::enqueue(Sequence& sequence, const TrackedFrame& frame) const {
    const ImagePyramid& live = frame.images.live;
    sequence.copy(host_record_, tracker_.record, sizeof(gpu::TrackingRecord));
    for (const Buffer* params : {&wide_params_, &fine_params_}) {
        frame.map.enqueue_prediction(sequence, *params, tracker_.record, frame.images, false, model_, model_color_);
        frame.pyramids.enqueue_model(sequence, *params, model_);
        tracker_.enqueue_frame(sequence, *params, live, model_);
    }
    sequence.dispatch(loop_samples_,
                      {{"params", fine_params_},
                       {"record", tracker_.record},
                       {"live_depth", live.depth[0]},
                       {"model_depth", model_.depth[0]},
                       {"cell_indices", frame.map.seen_surfels()},
                       {"appearance", frame.map.streams().appearance},
                       {"live_photometric", live.photometric[kQuarter]},
                       {"model_photometric", model_.photometric[kQuarter]},
                       {"samples", samples_}},
                      loop_samples_.groups_for(kSamples));
    sequence.copy(tracker_.record, host_record_, sizeof(gpu::TrackingRecord));
    sequence.copy(samples_, host_samples_, samples_.bytes());
    sequence.finish();
}

Alignment Aligner::align(const TrackedFrame& frame, ModelPart part, float min_overlap,
                         const Eigen::Isometry3d& T_world_camera) {
    set_params(frame.params, part);
    auto& record = host_record_.host<gpu::TrackingRecord>()[0];
    record = {};
    record.world_live = to_device(T_world_camera);
    record.fusion_weight = 1;
    if (!align_sequence_) {
        align_sequence_ = std::make_unique<Sequence>(context_);
        enqueue(*align_sequence_, frame);
    }
    align_sequence_->run();
    return judge(record, host_samples_.host<gpu::LoopSample>(), T_world_camera, min_overlap, config_);
}

void Aligner::reactivate(const TrackedFrame& frame, std::uint32_t active_since) {
    auto& params = fine_params_.host<gpu::Params>()[0];
    params = frame.params;
    params.active_since = active_since;
    if (!reactivate_sequence_) {
        reactivate_sequence_ = std::make_unique<Sequence>(context_);
        const SurfelStreams& s = frame.map.streams();
        reactivate_sequence_->dispatch_indirect(reactivate_,
                                                {{"params", fine_params_},
                                                 {"record", tracker_.record},
                                                 {"counters", frame.map.counters()},
                                                 {"inactive_depth", model_.depth[0]},
                                                 {"position_confidence", s.position_confidence},
                                                 {"appearance", s.appearance}},
                                                frame.map.surfel_groups(), 0);
        reactivate_sequence_->finish();
    }
    reactivate_sequence_->run();
}

}  // namespace posefusion
