#pragma once
#include <memory>

#include "engine/core/depth_noise.hpp"
#include "engine/core/intrinsics.hpp"
#include "engine/core/motion_judge.hpp"

namespace posefusion {

/// What moves, whatever it is: free space in the views of the last second (view_history.hpp), remembered from frame to
/// frame, collected over convex patches of surface, and cut out by the min-cut that cuts people (grid_cut.hpp).
/// @param noise  of the depth camera, as assumed by tracking and mapping (SlamConfig::noise)
/// Throws Error if the camera is invalid.
[[nodiscard]] std::unique_ptr<MotionJudge> make_motion_segmenter(const Intrinsics& camera, const DepthNoise& noise);

}  // namespace posefusion
