#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/geometry.glsl"
#include "include/se3.glsl"
#include "include/depth_test_read.glsl"
#include "include/association.glsl"
// One surface, two surfels: where drift had laid a second layer and a loop has brought it back onto the first, both would
// stay for good, each pass along the wall one more. Of two stable surfels in one pixel that are nearer than their
// size asks for and whose distance noise explains, the one less often seen is marked (ties: the later one); `clean` removes it.
// in:  static_depth [n], association [n], cells, surfel positions and normals
// out: owner [count], DOUBLE_SURFEL for what is to go; `merge` has no need of it any more
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint CELL_STRIDE = 2;
layout(constant_id = 1) const int INDEX_SCALE = 2;
layout(std430, binding = 0) readonly buffer ParamsBuffer { Params params; };
layout(std430, binding = 1) readonly buffer StaticDepth { float static_depth[]; };
layout(std430, binding = 2) readonly buffer Association { uint association[]; };
CELL_BUFFERS(3, 4)
layout(std430, binding = 5) readonly buffer Positions { vec4 position_confidence[]; };
layout(std430, binding = 6) readonly buffer Normals { vec4 normal_radius[]; };
layout(std430, binding = 7) buffer Owner { uint owner[]; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= params.width * params.height) return;
    uint a = association[i];
    if (a >= NEW_SURFEL || params.double_spacing <= 0.0) return;
    vec4 position = position_confidence[a];
    if (position.w < params.stable_confidence) return;
    vec4 shape = normal_radius[a];
    float gate = max(params.double_depth, params.double_sigmas * depth_sigma(params, static_depth[i]));
    uint v = i / params.width, u = i - v * params.width;
    uint scale = uint(INDEX_SCALE);
    for (uint k = 0u; k < scale * scale; ++k) {
        uint b = CELL_INDEX((v * scale + k / scale) * params.width * scale + u * scale + k % scale);
        if (b == EMPTY_CELL || b == a) continue;
        vec4 other = position_confidence[b];
        vec4 other_shape = normal_radius[b];
        vec3 offset = other.xyz - position.xyz;
        float height = dot(offset, shape.xyz);
        float spacing = params.double_spacing * min(shape.w, other_shape.w);
        bool same = other.w >= params.stable_confidence && abs(height) < gate && dot(shape.xyz, other_shape.xyz) > params.association_cosine &&
                    dot(offset, offset) - height * height < spacing * spacing;
        if (!same) continue;
        bool other_goes = other.w < position.w || (other.w == position.w && b > a);
        atomicExchange(owner[other_goes ? b : a], DOUBLE_SURFEL);
    }
}
