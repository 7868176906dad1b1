#pragma once
#include "engine/core/intrinsics.hpp"
#include "engine/slam/slam_config.hpp"
#include "engine/vulkan/shared_types.hpp"

namespace posefusion {

/// The configuration as the shaders read it: angles become cosines, pixel sizes are scaled to the image width. The
/// frame number stays 0.
[[nodiscard]] gpu::Params make_params(const Intrinsics& camera, const SlamConfig& config);

}  // namespace posefusion
