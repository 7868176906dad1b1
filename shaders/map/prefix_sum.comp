#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/chunks.glsl"
// Exclusive prefix sum of the chunk counts, in place, by one workgroup: each invocation adds a contiguous run.
// push: mode 0: counts of pixels, the total is appended to the map; mode 1: counts of map slots, the total replaces
//       counters.count (the compaction); pixels = number of pixels
layout(local_size_x = 256) in;
layout(push_constant) uniform Push { uint mode; uint pixels; };
buffer Counters { MapRecord counters; };
buffer ChunkCounts { uint chunk_counts[]; };

shared uint run_sums[256];

void main() {
    uint t = gl_LocalInvocationID.x;
    uint items = mode == 0u ? pixels : counters.count;
    uint chunks = (items + CHUNK - 1u) / CHUNK;
    uint run = (chunks + 255u) / 256u;
    uint first = min(t * run, chunks), last = min(first + run, chunks);
    uint sum = 0u;
    for (uint k = first; k < last; ++k) sum += chunk_counts[k];
    run_sums[t] = sum;
    barrier();
    uint before = 0u, total = 0u;
    for (uint k = 0u; k < 256u; ++k) {
        before += k < t ? run_sums[k] : 0u;
        total += run_sums[k];
    }
    for (uint k = first; k < last; ++k) {
        uint count = chunk_counts[k];
        chunk_counts[k] = before;
        before += count;
    }
    barrier();  // every invocation has read counters.count
    if (t == 0u) {
        if (mode == 0u) counters.appended = total;
        else counters.count = total;
    }
}
