#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#include "include/shared_types.h"
#include "include/geometry.glsl"
#include "include/se3.glsl"
#include "include/mask.glsl"
#include "include/association.glsl"
#include "include/when.glsl"
// Removes surfels that do not belong to the static scene:
//  * free space: static depth was measured well behind the surfel, also at its neighbours: the confidence decays, so a
//    person who was there before being noticed is gone within a few frames;
//    (the inactive model is spared: until a loop is closed it may just be displaced by the drift);
//  * unstable ones that were not seen again for params.unstable_timeout frames, unless tracking has failed;
//  * unstable ones at the depth of a person's pixel: they are the person;
//  * those that `find_duplicates` has marked.
// Counts what is alive, stable, and stable but inactive near the surface seen (integer atomics: the order does not matter).
layout(local_size_x = 256) in;
readonly buffer ParamsBuffer { Params params; };
readonly buffer Record { TrackingRecord record; };
readonly buffer StaticDepth { float static_depth[]; };
readonly buffer Depth { float depth[]; };
readonly buffer DilatedMask { uint dilated_mask[]; };
buffer Counters { MapRecord counters; };
buffer Positions { vec4 position_confidence[]; };
readonly buffer Appearances { uvec4 appearance[]; };
readonly buffer Owner { uint owner[]; };

const int NEIGHBOUR = 2;            // pixels
const float INACTIVE_NEAR = 0.30;  // metres; farther displaced, the inactive model cannot be aligned from here

// 1 if static depth at (u, v) lies behind z by more than the margin, -1 if a surface is measured near z, 0 if unknown
int evidence(Camera c, ivec2 uv, float z) {
    float d = static_depth[uv.y * int(c.width) + uv.x];
    if (d <= 0.0) return 0;
    float margin = max(params.free_space_margin, params.free_space_sigmas * depth_sigma(params, d));
    return d - z > margin ? 1 : -1;
}

void main() {
    Camera c = camera_at(params, 0u);
    Pose T_camera_world = inverse_pose(record.world_live);
    uint alive = 0u, stable = 0u, inactive = 0u;
    for (uint k = 0u; k < 4u; ++k) {
        uint i = (gl_WorkGroupID.x * 4u + k) * 256u + gl_LocalInvocationID.x;
        if (i >= counters.count) break;
        vec4 surfel = position_confidence[i];
        if (surfel.w <= 0.0) continue;
        float confidence = surfel.w;
        bool is_stable = confidence >= params.stable_confidence;
        vec3 p = transform(T_camera_world, surfel.xyz);
        ivec2 uv = ivec2(floor(clamp(project(c, vec3(p.xy, max(p.z, 0.1))), vec2(-8.0), vec2(c.width, c.height) + 8.0) + 0.5));
        bool in_view = p.z > 0.1 && uv.x >= NEIGHBOUR && uv.y >= NEIGHBOUR && uv.x < int(c.width) - NEIGHBOUR &&
                       uv.y < int(c.height) - NEIGHBOUR;
        bool is_active = appearance[i].w >= params.active_since;
        if (in_view && record.failed == 0u && is_active) {
            int through = evidence(c, uv, p.z);
            WHEN(through > 0) {
                through += evidence(c, uv + ivec2(NEIGHBOUR, 0), p.z) + evidence(c, uv - ivec2(NEIGHBOUR, 0), p.z) +
                           evidence(c, uv + ivec2(0, NEIGHBOUR), p.z) + evidence(c, uv - ivec2(0, NEIGHBOUR), p.z);
            }
            if (through >= 4) confidence *= params.free_space_decay;
            if (through >= 4 && confidence < 0.5) confidence = 0.0;
            if (!is_stable && MASK_BIT(dilated_mask, uv.x, uv.y, c.width) &&
                abs(depth[uv.y * int(c.width) + uv.x] - p.z) < params.free_space_margin + 2.0 * depth_sigma(params, p.z)) {
                confidence = 0.0;
            }
        }
        if (in_view && !is_active && is_stable) {
            float d = static_depth[uv.y * int(c.width) + uv.x];
            inactive += uint(d > 0.0 && abs(d - p.z) < INACTIVE_NEAR);
        }
        if (record.failed == 0u && !is_stable && params.frame - appearance[i].w > params.unstable_timeout) confidence = 0.0;
        if (owner[i] == DUPLICATE_SURFEL) confidence = 0.0;
        if (confidence != surfel.w) position_confidence[i].w = confidence;
        alive += uint(confidence > 0.0);
        stable += uint(confidence >= params.stable_confidence);
    }
    alive = subgroupAdd(alive);
    stable = subgroupAdd(stable);
    inactive = subgroupAdd(inactive);
    if (subgroupElect()) {
        atomicAdd(counters.alive, alive);
        atomicAdd(counters.stable, stable);
        atomicAdd(counters.inactive_in_view, inactive);
    }
}
