// Kernels that run once per surfel: each invocation takes SURFELS_PER_INVOCATION of them, those of its workgroup side
// by side. Their dispatch arguments are set by map/grow.
#ifndef POSEFUSION_PER_SURFEL
#define POSEFUSION_PER_SURFEL
#include "shared_constants.h"

layout(local_size_x = SURFEL_GROUP) in;

// The k-th surfel of this invocation; may be beyond the last one.
uint surfel_index(uint k) {
    return (gl_WorkGroupID.x * SURFELS_PER_INVOCATION + k) * SURFEL_GROUP + gl_LocalInvocationID.x;
}

#endif
