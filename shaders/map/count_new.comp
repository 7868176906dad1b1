#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/association.glsl"
#include "include/chunks.glsl"
// First step of the append: how many of each chunk of pixels become new surfels.
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer ParamsBuffer { Params params; };
layout(std430, binding = 1) readonly buffer Association { uint association[]; };
layout(std430, binding = 2) writeonly buffer Counts { uint counts[]; };

void main() {
    uint n = params.width * params.height;
    uint chunk = gl_GlobalInvocationID.x;
    if (chunk * CHUNK >= n) return;
    uint count = 0u;
    for (uint k = 0u; k < CHUNK; ++k) {
        uint i = chunk * CHUNK + k;
        count += uint(i < n && association[min(i, n - 1u)] == NEW_SURFEL);
    }
    counts[chunk] = count;
}
