#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#include "include/shared_types.h"
#include "include/color.glsl"
#include "include/geometry.glsl"
#include "include/mask.glsl"
#include "include/noise.glsl"
#include "include/per_surfel.glsl"
#include "include/se3.glsl"
#include "include/when.glsl"
// Removes surfels that do not belong to the static scene:
//  * free space: static depth was measured well behind the surfel, also at its neighbours: the confidence decays, so
//    that a person who was there before being noticed is gone within a few frames
//    (the inactive model is spared: until a loop is closed it may just be displaced by the drift);
//  * unstable ones that were not seen again for params.unstable_timeout frames, unless tracking has failed;
//  * unstable ones at the depth that was measured at a person's pixel: they are the person (in the dilated border of
//    the mask, mostly the scene is measured, and its surfels stay);
//  * all of them there where a thing begins to move that stood still: they are the thing;
//  * those that `find_duplicates` has marked.
// Counts live surfels, stable ones, stable but inactive ones near the surface seen, active ones where depth was
// measured, and those of them that are seen through (integer atomics: the order does not matter).
readonly buffer ParamsBuffer { Params params; };
readonly buffer Record { TrackingRecord record; };
readonly buffer StaticDepth { float static_depth[]; };
readonly buffer Depth { float depth[]; };
readonly buffer Color { uint color[]; };
readonly buffer Mask { uint mask[]; };
buffer Counters { MapRecord counters; };
buffer Positions { vec4 position_confidence[]; };
readonly buffer Appearances { uvec4 appearance[]; };
readonly buffer Owner { uint owner[]; };

// 1 if static depth at (u, v) lies behind z by more than the margin, -1 if a surface is measured near z, 0 if unknown
int evidence(Camera c, ivec2 uv, float z) {
    float d = static_depth[index_of(c, uv)];
    if (d <= 0.0) return 0;
    float margin = max(params.free_space_margin, params.free_space_sigmas * depth_sigma(params, d));
    return d - z > margin ? 1 : -1;
}

void main() {
    Camera c = camera_at(params, 0u);
    Pose T_camera_world = inverse_pose(record.world_live);
    uint alive = 0u, stable = 0u, inactive = 0u, measured = 0u, seen_through = 0u;
    for (uint k = 0u; k < SURFELS_PER_INVOCATION; ++k) {
        uint i = surfel_index(k);
        if (i >= counters.count) break;
        vec4 surfel = position_confidence[i];
        if (surfel.w <= 0.0) continue;
        float confidence = surfel.w;
        bool is_stable = confidence >= params.stable_confidence;
        vec3 p = transform(T_camera_world, surfel.xyz);
        ivec2 uv = nearest_pixel(c, project(c, vec3(p.xy, max(p.z, NEAR_PLANE))));
        bool in_view = p.z > NEAR_PLANE && in_image(c, uv - FREE_SPACE_NEIGHBOUR) &&
                       in_image(c, uv + FREE_SPACE_NEIGHBOUR);
        bool is_active = appearance[i][LAST_SEEN] >= params.active_since;
        if (in_view && record.failed == 0u && is_active) {
            int through = evidence(c, uv, p.z);
            measured += uint(through != 0);
            WHEN(through > 0) {
                const ivec2 across = ivec2(FREE_SPACE_NEIGHBOUR, 0), down = ivec2(0, FREE_SPACE_NEIGHBOUR);
                through += evidence(c, uv + across, p.z) + evidence(c, uv - across, p.z) +
                           evidence(c, uv + down, p.z) + evidence(c, uv - down, p.z);
            }
            seen_through += uint(through >= MIN_FREE_VOTES);
            if (through >= MIN_FREE_VOTES) confidence *= params.free_space_decay;
            if (through >= MIN_FREE_VOTES && confidence < MIN_CONFIDENCE) confidence = 0.0;
            float person_gate = params.free_space_margin + PERSON_SIGMAS * depth_sigma(params, p.z);
            uint pixel = index_of(c, uv);
            if (MASK_BIT(mask, uv.x, uv.y, c.width) && abs(depth[pixel] - p.z) < person_gate &&
                (!is_stable || tag_of(color[pixel]) >= params.first_mover_label)) {
                confidence = 0.0;
            }
        }
        if (in_view && !is_active && is_stable) {
            float d = static_depth[index_of(c, uv)];
            inactive += uint(d > 0.0 && abs(d - p.z) < INACTIVE_NEAR);
        }
        bool seen_lately = params.frame - appearance[i][LAST_SEEN] <= params.unstable_timeout;
        if (record.failed == 0u && !is_stable && !seen_lately) confidence = 0.0;
        if (owner[i] == DUPLICATE_SURFEL) confidence = 0.0;
        if (confidence != surfel.w) position_confidence[i].w = confidence;
        alive += uint(confidence > 0.0);
        stable += uint(confidence >= params.stable_confidence);
    }
    alive = subgroupAdd(alive);
    stable = subgroupAdd(stable);
    inactive = subgroupAdd(inactive);
    measured = subgroupAdd(measured);
    seen_through = subgroupAdd(seen_through);
    if (subgroupElect()) {
        atomicAdd(counters.alive, alive);
        atomicAdd(counters.stable, stable);
        atomicAdd(counters.inactive_in_view, inactive);
        atomicAdd(counters.in_view, measured);
        atomicAdd(counters.seen_through, seen_through);
    }
}
