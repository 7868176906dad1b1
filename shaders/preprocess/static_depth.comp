#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/exposure.glsl"
#include "include/mask.glsl"
// Where a person's pixels leave the depth image: static depth is depth in range and outside of the dilated person mask,
// else 0. The intensity is -1 in the mask, so that tracking needs no mask either; it is in the exposure of the map, as
// well as the last frame's exposure tells.
// in:  depth [n] metres, color [n], dilated_mask
// out: static_depth [n] metres, intensity [n] 0..1 or -1
layout(local_size_x = GROUP) in;
readonly buffer ParamsBuffer { Params params; };
readonly buffer Record { TrackingRecord record; };
readonly buffer Depth { float depth[]; };
readonly buffer Color { uint color[]; };
readonly buffer DilatedMask { uint dilated_mask[]; };
writeonly buffer StaticDepth { float static_depth[]; };
writeonly buffer Intensity { float intensity[]; };

void main() {
    uint first = gl_WorkGroupID.x * gl_WorkGroupSize.x * PIXELS_PER_INVOCATION + gl_LocalInvocationID.x;
    for (uint k = 0u; k < PIXELS_PER_INVOCATION; ++k) {
        uint i = first + k * gl_WorkGroupSize.x;
        if (i >= params.width * params.height) return;
        uint v = i / params.width;
        uint u = i - v * params.width;
        bool person = MASK_BIT(dilated_mask, u, v, params.width);
        float z = depth[i];
        bool usable = !person && z >= params.depth_min && z <= params.depth_max;  // false for NaN, too
        static_depth[i] = usable ? z : 0.0;
        intensity[i] = person ? -1.0 : luma(in_map_exposure(record, color[i]));
    }
}
