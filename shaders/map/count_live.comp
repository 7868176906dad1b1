#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/chunks.glsl"
// First step of the compaction: how many surfels of each chunk of slots are alive.
layout(local_size_x = 64) in;
layout(std430, binding = 0) readonly buffer Map { MapRecord map; };
layout(std430, binding = 1) readonly buffer Positions { vec4 position_confidence[]; };
layout(std430, binding = 2) writeonly buffer Counts { uint counts[]; };

void main() {
    uint chunk = gl_GlobalInvocationID.x;
    if (chunk * CHUNK >= map.count) return;
    uint count = 0u;
    for (uint k = 0u; k < CHUNK; ++k) {
        uint i = chunk * CHUNK + k;
        count += uint(i < map.count && position_confidence[min(i, map.count - 1u)].w > 0.0);
    }
    counts[chunk] = count;
}
