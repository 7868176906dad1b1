#pragma once
#include <cstddef>
#include <cstdint>

/// The numbers and structures that C++ shares with the shaders, byte by byte.
namespace posefusion::gpu {

using uint = std::uint32_t;
struct alignas(16) vec4 {
    float x = 0, y = 0, z = 0, w = 0;
};

#include "shaders/include/shared_constants.h"
#include "shaders/include/shared_types.h"

static_assert(sizeof(Pose) == 48 && offsetof(TrackingRecord, icp_scale) == 240 && sizeof(DispatchArguments) == 12);
static_assert(sizeof(DeformNode) == 32 && sizeof(DeformCandidate) == 32 && sizeof(DeformBranch) == 8 &&
              sizeof(DeformLeaf) == 48);

}  // namespace posefusion::gpu
