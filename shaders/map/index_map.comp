#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/depth_test.glsl"
#include "include/geometry.glsl"
#include "include/per_surfel.glsl"
#include "include/se3.glsl"
// Index map: every surfel of the active model in view as one point in an image with INDEX_SCALE x INDEX_SCALE cells per
// pixel.
// in:  position_confidence [count], appearance [count], record.world_live, counters.count
// out: cells [INDEX_SCALE^2 * n], nearest surfel of each; cleared to EMPTY_CELL before
layout(constant_id = 0) const uint INDEX_SCALE = 1;
layout(push_constant) uniform Push { uint pass; };
readonly buffer ParamsBuffer { Params params; };
readonly buffer Record { TrackingRecord record; };
readonly buffer Counters { MapRecord counters; };
readonly buffer Positions { vec4 position_confidence[]; };
readonly buffer Appearances { uvec4 appearance[]; };
DEPTH_TEST_BUFFERS

void main() {
    Camera c = camera_at(params, 0u);
    Pose T_camera_world = inverse_pose(record.world_live);
    float scale = float(INDEX_SCALE);
    ivec2 size = ivec2(c.width, c.height) * int(INDEX_SCALE);
    for (uint k = 0u; k < SURFELS_PER_INVOCATION; ++k) {
        uint i = surfel_index(k);
        if (i >= counters.count) return;
        vec4 surfel = position_confidence[i];
        vec3 p = transform(T_camera_world, surfel.xyz);
        bool in_range = p.z >= params.depth_min * INDEX_NEARER && p.z <= params.depth_max * INDEX_FARTHER;
        if (surfel.w <= 0.0 || !in_range) continue;
        vec2 uv = (project(c, p) + 0.5) * scale;  // cell k covers [k, k + 1) here
        ivec2 cell = ivec2(floor(clamp(uv, vec2(-1.0), vec2(size) + 1.0)));
        if (cell.x < 0 || cell.y < 0 || cell.x >= size.x || cell.y >= size.y) continue;
        if (appearance[i][LAST_SEEN] < params.active_since) continue;
        DEPTH_TEST(uint(cell.y * size.x + cell.x), floatBitsToUint(p.z), i);
    }
}
