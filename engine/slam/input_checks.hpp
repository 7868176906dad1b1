#pragma once
#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "engine/slam/slam_config.hpp"

/// What the engine refuses, each with an Error that says what to do.
namespace posefusion {

/// The same camera, or Error if it cannot be worked with.
const Intrinsics& checked(const Intrinsics& camera);
/// The same configuration, or Error if its numbers make no sense.
const SlamConfig& checked(const SlamConfig& config);
/// Images of a frame must have the size of the camera; there may be no labels.
void check_sizes(const Intrinsics& camera, const ColorImage& color, const DepthImage& depth, const LabelImage& labels);
/// A state must have been taken with the camera that it is restored for.
void check_same_camera(const Intrinsics& is, const Intrinsics& was);

}  // namespace posefusion
