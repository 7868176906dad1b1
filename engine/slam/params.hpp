#pragma once
#include "engine/core/intrinsics.hpp"
#include "engine/slam/slam_config.hpp"
#include "engine/vulkan/shared_types.hpp"

namespace posefusion {

/// The configuration as the shaders read it: degrees become cosines, pixel sizes are brought to the image's width.
/// Leaves the frame number at 0.
[[nodiscard]] gpu::Params make_params(const Intrinsics& camera, const SlamConfig& config);

}  // namespace posefusion
