#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_constants.h"
#include "include/shared_types.h"
#include "include/mask.glsl"
// The static depth image: depth in range and outside the (dilated) person mask, else 0. And the intensity, -1 there
// where a person is, so that no later kernel needs the mask again.
// in:  depth [n] metres, color [n], dilated_mask
// out: static_depth [n] metres, intensity [n] Rec. 601 luma in 0..1 or -1
layout(local_size_x = 64) in;
readonly buffer ParamsBuffer { Params params; };
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
        vec3 rgb = unpackUnorm4x8(color[i]).rgb;
        intensity[i] = person ? -1.0 : dot(rgb, vec3(0.299, 0.587, 0.114));
    }
}
