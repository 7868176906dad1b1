#include "engine/tracking/exposure.hpp"

namespace posefusion {

using namespace vulkan;

namespace {

std::uint32_t groups_of(const Intrinsics& camera) {
    const auto blocks = [](int side) { return static_cast<std::uint32_t>(side) / gpu::EXPOSURE_BLOCK; };
    return ceil_div(blocks(camera.width) * blocks(camera.height), gpu::REDUCTION_PIXELS_PER_GROUP);
}

}  // namespace

Exposure::Exposure(Context& context, const Intrinsics& camera)
    : groups_(groups_of(camera)),
      rows_(device_buffer<float>(context, groups_ * gpu::REDUCTION_MAX_ROWS * gpu::REDUCTION_COLUMNS, "exposure rows")),
      row_counts_(device_buffer<std::uint32_t>(context, groups_, "exposure row counts")),
      reduce_(context, "tracking/exposure_reduce"),
      solve_(context, "tracking/exposure_solve") {}

void Exposure::enqueue(Sequence& sequence, const Buffer& params, const Buffer& record, const Preprocessing& frame,
                       const Buffer& model_geometry, const Buffer& model_color) const {
    sequence.stage("exposure");
    sequence.dispatch(reduce_,
                      {{"params", params},
                       {"record", record},
                       {"live_depth", frame.live.depth[0]},
                       {"model_geometry", model_geometry},
                       {"color", frame.color},
                       {"model_color", model_color},
                       {"rows", rows_},
                       {"row_counts", row_counts_}},
                      groups_);
    sequence.dispatch(solve_, {{"rows", rows_}, {"row_counts", row_counts_}, {"record", record}}, {{"groups", groups_}},
                      1);
}

}  // namespace posefusion
