#include "engine/tracking/timing_probe.hpp"

namespace posefusion {

using namespace vulkan;

TimingProbe::View::View(Context& context, const Intrinsics& camera, const std::string& name)
    : geometry(device_buffer<gpu::vec4>(context, pixels_at(camera, kLevel), name + " geometry")),
      photometric(device_buffer<gpu::vec4>(context, pixels_at(camera, kLevel), name + " photometric")),
      record(device_buffer<gpu::TrackingRecord>(context, 1, name + " record")) {}

TimingProbe::TimingProbe(Context& context, const Intrinsics& camera, bool rolling)
    : context_(context),
      camera_(camera),
      previous_(context, camera, "previous frame"),
      next_reference_(context, camera, "next reference"),
      reference_(context, camera, "reference"),
      pair_(device_buffer<gpu::TrackingRecord>(context, 1, "pair of frames")),
      rows_(device_buffer<float>(context,
                                 ceil_div(pixels_at(camera, kLevel), gpu::REDUCTION_PIXELS_PER_GROUP) *
                                     gpu::REDUCTION_MAX_ROWS * gpu::TIMING_COLUMNS,
                                 "timing rows")),
      row_counts_(device_buffer<std::uint32_t>(
          context, ceil_div(pixels_at(camera, kLevel), gpu::REDUCTION_PIXELS_PER_GROUP), "timing row counts")),
      sums_(device_buffer<float>(context, gpu::TIMING_COLUMNS, "timing sums")),
      host_sums_(host_buffer<float>(context, gpu::TIMING_COLUMNS, "host timing sums")),
      begin_(context, "tracking/timing_begin"),
      reduce_(context, "tracking/track_reduce", {{"ROLLING", rolling ? 1u : 0u}, {"TIMING", 1u}, {"TURN", 0u}}),
      sum_(context, "tracking/timing_sum") {}

void TimingProbe::enqueue_copy(Sequence& sequence, const View& from, const View& to) const {
    const std::size_t bytes = pixels_at(camera_, kLevel) * sizeof(gpu::vec4);
    sequence.copy(from.geometry, to.geometry, bytes);
    sequence.copy(from.photometric, to.photometric, bytes);
    sequence.copy(from.record, to.record, sizeof(gpu::TrackingRecord));
}

void TimingProbe::record_commands(const Buffer& params, const Buffer& record, const ImagePyramid& live) {
    const std::uint32_t groups = ceil_div(pixels_at(camera_, kLevel), gpu::REDUCTION_PIXELS_PER_GROUP);
    compare_ = std::make_unique<Sequence>(context_);
    compare_->dispatch(
        begin_, {{"record", record}, {"previous", previous_.record}, {"reference", reference_.record}, {"pair", pair_}},
        1);
    compare_->dispatch(reduce_,
                       {{"params", params},
                        {"live_geometry", previous_.geometry},
                        {"live_photometric", previous_.photometric},
                        {"model_geometry", reference_.geometry},
                        {"model_photometric", reference_.photometric},
                        {"record", pair_},
                        {"rows", rows_},
                        {"row_counts", row_counts_}},
                       {{"level", kLevel}, {"step", 1u}}, groups);
    compare_->dispatch(sum_, {{"rows", rows_}, {"row_counts", row_counts_}, {"timing_sums", sums_}},
                       {{"groups", groups}}, 1);
    compare_->copy(sums_, host_sums_, gpu::TIMING_COLUMNS * sizeof(float));
    compare_->finish();

    change_reference_ = std::make_unique<Sequence>(context_);
    enqueue_copy(*change_reference_, next_reference_, reference_);
    enqueue_copy(*change_reference_, previous_, next_reference_);
    change_reference_->finish();

    keep_ = std::make_unique<Sequence>(context_);
    const std::size_t bytes = pixels_at(camera_, kLevel) * sizeof(gpu::vec4);
    keep_->copy(live.geometry[kLevel], previous_.geometry, bytes);
    keep_->copy(live.photometric[kLevel], previous_.photometric, bytes);
    keep_->copy(record, previous_.record, sizeof(gpu::TrackingRecord));
    keep_->finish();
}

std::span<const float> TimingProbe::after_frame(bool tracked, const Buffer& params, const Buffer& record,
                                                const ImagePyramid& live) {
    if (!keep_) record_commands(params, record, live);
    tracked_ = tracked ? tracked_ + 1 : 0;
    if (tracked_ < 2) {  // no motion is known
        keep_->run();
        return {};
    }
    const bool has_reference = tracked_ > 2 * kReferenceEvery + 1;
    // until there is a reference this only determines the motion of the previous frame
    compare_->run();
    if (tracked_ % kReferenceEvery == 0) change_reference_->run();
    keep_->run();
    return has_reference ? host_sums_.host<float>() : std::span<const float>{};
}

}  // namespace posefusion
