#include "engine/preprocess/global_shutter.hpp"

#include "engine/preprocess/preprocessing.hpp"

namespace posefusion {

using namespace vulkan;

void set_params(gpu::Params& params, const ShutterConfig& config, const Intrinsics& camera) {
    constexpr float kSeconds = 1e-3f;
    const auto rows = static_cast<float>(camera.height);
    const auto first_row = [&](float readout_ms) { return (0.5f / rows - config.stamp_row) * readout_ms * kSeconds; };
    params.color_first_row = first_row(config.color_readout_ms);
    params.stamp_row = config.stamp_row;
    params.color_per_row = config.color_readout_ms * kSeconds / rows;
    params.depth_first_row = first_row(config.depth_readout_ms) + config.depth_delay_ms * kSeconds;
    params.depth_per_row = config.depth_readout_ms * kSeconds / rows;
}

GlobalShutter::GlobalShutter(Context& context, const Intrinsics& camera)
    : camera_(camera),
      rolling_depth_(device_buffer<float>(context, pixels_at(camera, 0), "rolling depth")),
      rolling_color_(device_buffer<std::uint32_t>(context, pixels_at(camera, 0), "rolling colour")),
      kernel_(context, "preprocess/global_shutter") {}

void GlobalShutter::enqueue(Sequence& sequence, const Buffer& params, const Buffer& record, const Buffer& host_depth,
                            const Buffer& host_color, const Buffer& depth, const Buffer& color, Motion motion) const {
    const std::uint32_t n = pixels_at(camera_, 0);
    sequence.copy(host_depth, rolling_depth_, n * sizeof(float));
    sequence.copy(host_color, rolling_color_, n * sizeof(std::uint32_t));
    sequence.dispatch(kernel_,
                      {{"params", params},
                       {"record", record},
                       {"rolling_depth", rolling_depth_},
                       {"rolling_color", rolling_color_},
                       {"depth", depth},
                       {"color", color}},
                      {{"found", static_cast<std::uint32_t>(motion)}}, kernel_.groups_for(n));
}

}  // namespace posefusion
