#pragma once
#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "engine/slam/slam_config.hpp"

/// Validation of the engine's input. Every Error says what to do.
namespace posefusion {

/// Returns the camera, or throws Error if it is unusable.
const Intrinsics& checked(const Intrinsics& camera);
/// Returns the configuration, or throws Error if its values are inconsistent.
const SlamConfig& checked(const SlamConfig& config);
/// Images of a frame must have the size of the camera; labels may be empty.
void check_sizes(const Intrinsics& camera, const ColorImage& color, const DepthImage& depth, const LabelImage& labels);
/// A state must stem from the camera that it is restored for.
void check_same_camera(const Intrinsics& is, const Intrinsics& was);

}  // namespace posefusion
