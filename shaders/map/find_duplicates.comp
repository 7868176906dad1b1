#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/depth_test_read.glsl"
#include "include/noise.glsl"
// Two surfels of one surface: where drift had created a second layer and a loop has moved it back onto the first, both
// would remain, and every visit would add one. Of two stable surfels of different visits that lie in one pixel, nearer
// to each other than their size requires and no farther apart than depth noise explains, the coarser is marked (ties:
// the later one); `clean` removes it. A much coarser one is kept.
// in:  static_depth [n], association [n], cells, surfels
// out: owner [count], DUPLICATE_SURFEL for what is to be removed; `fuse` has read the owners before
layout(local_size_x = GROUP) in;
layout(constant_id = 0) const uint CELL_STRIDE = 1;
layout(constant_id = 1) const uint INDEX_SCALE = 1;
readonly buffer ParamsBuffer { Params params; };
readonly buffer StaticDepth { float static_depth[]; };
readonly buffer Association { uint association[]; };
readonly buffer CellIndices { uint cell_indices[]; };
readonly buffer Positions { vec4 position_confidence[]; };
readonly buffer Normals { vec4 normal_radius[]; };
readonly buffer Appearances { uvec4 appearance[]; };
buffer Owner { uint owner[]; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= params.width * params.height) return;
    uint a = association[i];
    if (a >= NEW_SURFEL || params.duplicate_spacing <= 0.0) return;
    vec4 position = position_confidence[a];
    if (position.w < params.stable_confidence) return;
    vec4 shape = normal_radius[a];
    float gate = max(params.duplicate_depth, params.duplicate_sigmas * depth_sigma(params, static_depth[i]));
    uint v = i / params.width, u = i - v * params.width;
    for (uint k = 0u; k < INDEX_SCALE * INDEX_SCALE; ++k) {
        uint row = v * INDEX_SCALE + k / INDEX_SCALE, column = u * INDEX_SCALE + k % INDEX_SCALE;
        uint b = CELL_INDEX(row * params.width * INDEX_SCALE + column);
        if (b == EMPTY_CELL || b == a) continue;
        vec4 other = position_confidence[b];
        vec4 other_shape = normal_radius[b];
        vec3 offset = other.xyz - position.xyz;
        float height = dot(offset, shape.xyz);
        uint created = appearance[a][CREATED], other_created = appearance[b][CREATED];
        uint age = max(created, other_created) - min(created, other_created);
        float finer = min(shape.w, other_shape.w), coarser = max(shape.w, other_shape.w);
        float spacing = params.duplicate_spacing * finer;
        bool same = other.w >= params.stable_confidence && age >= params.duplicate_age &&
                    coarser < MUCH_COARSER * finer && abs(height) < gate &&
                    dot(shape.xyz, other_shape.xyz) > params.association_cosine &&
                    dot(offset, offset) - height * height < spacing * spacing;
        if (!same) continue;
        bool later = other_created > created || (other_created == created && b > a);
        bool other_goes = other_shape.w > shape.w || (other_shape.w == shape.w && later);
        atomicExchange(owner[other_goes ? b : a], DUPLICATE_SURFEL);
    }
}
