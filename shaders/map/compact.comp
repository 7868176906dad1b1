#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
// Copies the live surfels to new buffers without gaps, keeping their order.
// push: slots in use before the compaction (counters.count already holds the number after it)
layout(local_size_x = GROUP) in;
layout(push_constant) uniform Push { uint slots; };
readonly buffer ChunkOffsets { uint chunk_offsets[]; };
readonly buffer Positions { vec4 position_confidence[]; };
readonly buffer Normals { vec4 normal_radius[]; };
readonly buffer Appearances { uvec4 appearance[]; };
writeonly buffer NewPositions { vec4 new_position_confidence[]; };
writeonly buffer NewNormals { vec4 new_normal_radius[]; };
writeonly buffer NewAppearances { uvec4 new_appearance[]; };

void main() {
    uint chunk = gl_GlobalInvocationID.x;
    if (chunk * CHUNK >= slots) return;
    uint to = chunk_offsets[chunk];
    for (uint k = 0u; k < CHUNK; ++k) {
        uint i = chunk * CHUNK + k;
        if (i >= slots || position_confidence[i].w <= 0.0) continue;
        new_position_confidence[to] = position_confidence[i];
        new_normal_radius[to] = normal_radius[i];
        new_appearance[to] = appearance[i];
        ++to;
    }
}
