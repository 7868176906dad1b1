#pragma once
#include <cstddef>
#include <cstdint>
#include <glm/vec4.hpp>

/// Constants and structures that C++ shares with the shaders, byte by byte.
namespace posefusion::gpu {

using glm::uint;
using glm::uvec4;
using glm::vec4;

#include "shaders/include/shared_constants.h"
#include "shaders/include/shared_types.h"

// std430 begins a vec4, and a structure that holds one, at multiples of 16 bytes and fills the end up likewise. C++
// packs them: the two agree where nothing has to be filled up.
static_assert(sizeof(uint) == 4 && sizeof(vec4) == 16 && sizeof(uvec4) == 16);
static_assert(sizeof(Params) % alignof(float) == 0 && alignof(Params) == alignof(float));  // only 4-byte members
static_assert(offsetof(Twist, rotation) == 16 && sizeof(Twist) == 32);
static_assert(offsetof(Pose, row1) == 16 && offsetof(Pose, row2) == 32 && sizeof(Pose) == 48);
static_assert(offsetof(TrackingRecord, world_model) == 48 && offsetof(TrackingRecord, world_live) == 96 &&
              offsetof(TrackingRecord, so3) == 144 && offsetof(TrackingRecord, so3_best) == 192 &&
              offsetof(TrackingRecord, expected_motion) == 240 && offsetof(TrackingRecord, motion_error) == 304 &&
              offsetof(TrackingRecord, frame_motion) == 336 && offsetof(TrackingRecord, turn_offset) == 384 &&
              offsetof(TrackingRecord, exposure) == 432 && offsetof(TrackingRecord, icp_scale) == 448 &&
              offsetof(TrackingRecord, hessian) == 496 && sizeof(TrackingRecord) == 592);
static_assert(offsetof(StartRecord, known) == 48 && sizeof(StartRecord) == 64);
static_assert(sizeof(MapRecord) == 28);
static_assert(offsetof(LoopSample, created) == 16 && sizeof(LoopSample) == 32);
static_assert(offsetof(SurfelSample, created) == 16 && sizeof(SurfelSample) == 32);
static_assert(offsetof(DeformNode, translation) == 16 && sizeof(DeformNode) == 32);
static_assert(sizeof(DeformBranch) == 8);
static_assert(offsetof(DeformLeaf, high) == 16 && offsetof(DeformLeaf, begin) == 32 && sizeof(DeformLeaf) == 48);
static_assert(offsetof(DeformCandidate, last_seen) == 16 && sizeof(DeformCandidate) == 32);
static_assert(sizeof(DispatchArguments) == 12);

}  // namespace posefusion::gpu
