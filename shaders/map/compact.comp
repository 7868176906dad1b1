#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/chunks.glsl"
// Copies the live surfels to the twin buffers without gaps, keeping their order.
// push: slots in use before the compaction (map.count already holds the number after it)
layout(local_size_x = 64) in;
layout(push_constant) uniform Push { uint slots; };
layout(std430, binding = 0) readonly buffer Offsets { uint offsets[]; };
layout(std430, binding = 1) readonly buffer Positions { vec4 position_confidence[]; };
layout(std430, binding = 2) readonly buffer Normals { vec4 normal_radius[]; };
layout(std430, binding = 3) readonly buffer Appearances { uvec4 appearance[]; };
layout(std430, binding = 4) writeonly buffer TwinPositions { vec4 twin_position_confidence[]; };
layout(std430, binding = 5) writeonly buffer TwinNormals { vec4 twin_normal_radius[]; };
layout(std430, binding = 6) writeonly buffer TwinAppearances { uvec4 twin_appearance[]; };

void main() {
    uint chunk = gl_GlobalInvocationID.x;
    if (chunk * CHUNK >= slots) return;
    uint to = offsets[chunk];
    for (uint k = 0u; k < CHUNK; ++k) {
        uint i = chunk * CHUNK + k;
        if (i >= slots || position_confidence[i].w <= 0.0) continue;
        twin_position_confidence[to] = position_confidence[i];
        twin_normal_radius[to] = normal_radius[i];
        twin_appearance[to] = appearance[i];
        ++to;
    }
}
