#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
// First step of the append: counts the pixels that become new surfels in each chunk of pixels.
layout(local_size_x = GROUP) in;
readonly buffer ParamsBuffer { Params params; };
readonly buffer Association { uint association[]; };
writeonly buffer ChunkCounts { uint chunk_counts[]; };

void main() {
    uint n = params.width * params.height;
    uint chunk = gl_GlobalInvocationID.x;
    if (chunk * CHUNK >= n) return;
    uint count = 0u;
    for (uint k = 0u; k < CHUNK; ++k) {
        uint i = chunk * CHUNK + k;
        count += uint(i < n && association[min(i, n - 1u)] == NEW_SURFEL);
    }
    chunk_counts[chunk] = count;
}
