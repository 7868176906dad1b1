#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
// Exclusive prefix sum of the chunk counts, in place, by one workgroup: each invocation adds up a contiguous run.
// push: counts_of: COUNTS_OF_PIXELS, the total becomes counters.appended, or COUNTS_OF_SLOTS, it becomes
//       counters.count; pixels: their number
const uint RUNS = 256u;
layout(local_size_x = RUNS) in;
layout(push_constant) uniform Push { uint counts_of; uint pixels; };
buffer Counters { MapRecord counters; };
buffer ChunkCounts { uint chunk_counts[]; };

shared uint run_sums[gl_WorkGroupSize.x];

void main() {
    uint t = gl_LocalInvocationID.x;
    uint items = counts_of == COUNTS_OF_PIXELS ? pixels : counters.count;
    uint chunks = (items + CHUNK - 1u) / CHUNK;
    uint run = (chunks + gl_WorkGroupSize.x - 1u) / gl_WorkGroupSize.x;
    uint first = min(t * run, chunks), last = min(first + run, chunks);
    uint sum = 0u;
    for (uint k = first; k < last; ++k) sum += chunk_counts[k];
    run_sums[t] = sum;
    barrier();
    uint before = 0u, total = 0u;
    for (uint k = 0u; k < gl_WorkGroupSize.x; ++k) {
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
        if (counts_of == COUNTS_OF_PIXELS) counters.appended = total;
        else counters.count = total;
    }
}
