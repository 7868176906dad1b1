#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
// First step of the compaction: counts the live surfels in each chunk of slots.
layout(local_size_x = GROUP) in;
readonly buffer Counters { MapRecord counters; };
readonly buffer Positions { vec4 position_confidence[]; };
writeonly buffer ChunkCounts { uint chunk_counts[]; };

void main() {
    uint chunk = gl_GlobalInvocationID.x;
    if (chunk * CHUNK >= counters.count) return;
    uint count = 0u;
    for (uint k = 0u; k < CHUNK; ++k) {
        uint i = chunk * CHUNK + k;
        count += uint(i < counters.count && position_confidence[min(i, counters.count - 1u)].w > 0.0);
    }
    chunk_counts[chunk] = count;
}
