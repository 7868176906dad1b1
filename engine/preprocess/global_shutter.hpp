#pragma once
#include <cstdint>

#include "engine/core/intrinsics.hpp"
#include "engine/preprocess/shutter_config.hpp"
#include "engine/vulkan/sequence.hpp"
#include "engine/vulkan/shared_types.hpp"

namespace posefusion {

/// Copies the read-out times of the rows into the kernels' parameters. @param camera  of the images
void set_params(gpu::Params& params, const ShutterConfig& config, const Intrinsics& camera);

/// Turns a frame whose rows were taken at different times into one taken at its stamp. The tracker corrects the error
/// of the motion that is expected; what it has found is better for all that follows.
class GlobalShutter {
public:
    /// By which motion of the camera: TrackingRecord::expected_motion, or frame_motion.
    enum class Motion : std::uint32_t { Expected, Found };

    GlobalShutter(vulkan::Context& context, const Intrinsics& camera);
    /// @param host_depth, host_color  input, as uploaded
    /// @param depth, color            output, of the same layout
    void enqueue(vulkan::Sequence& sequence, const vulkan::Buffer& params, const vulkan::Buffer& record,
                 const vulkan::Buffer& host_depth, const vulkan::Buffer& host_color, const vulkan::Buffer& depth,
                 const vulkan::Buffer& color, Motion motion) const;

private:
    Intrinsics camera_;
    vulkan::Buffer rolling_depth_, rolling_color_;
    vulkan::Kernel kernel_;
};

}  // namespace posefusion
