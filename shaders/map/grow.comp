#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
// Adds the appended surfels to the map's count and sets the dispatch arguments of the kernels that run once per surfel.
layout(local_size_x = 1) in;
buffer Counters { MapRecord counters; };
writeonly buffer Arguments { DispatchArguments arguments[]; };

void main() {
    counters.count += counters.appended;
    counters.appended = 0u;
    counters.alive = 0u;
    counters.stable = 0u;
    counters.inactive_in_view = 0u;
    counters.in_view = 0u;
    counters.seen_through = 0u;
    arguments[0] = DispatchArguments((counters.count + SURFELS_PER_GROUP - 1u) / SURFELS_PER_GROUP, 1u, 1u);
}
