#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/depth_test.glsl"
#include "include/geometry.glsl"
#include "include/per_surfel.glsl"
#include "include/se3.glsl"
// Prediction, first half: every confident surfel of the active model (or of the inactive one) drawn as its disc; per
// pixel the best of the nearest surface wins (disc.glsl).
// in:  surfel positions, normals and times, view pose (record.world_live of the bound record), counters.count
// out: cells [n], cleared to EMPTY_CELL before
layout(push_constant) uniform Push { uint pass; };
readonly buffer ParamsBuffer { Params params; };
readonly buffer Record { TrackingRecord record; };
readonly buffer Counters { MapRecord counters; };
readonly buffer Positions { vec4 position_confidence[]; };
readonly buffer Normals { vec4 normal_radius[]; };
readonly buffer Appearances { uvec4 appearance[]; };
DEPTH_TEST_BUFFERS
#include "include/disc.glsl"

void main() {
    Camera c = camera_at(params, 0u);
    Pose T_camera_world = inverse_pose(record.world_live);
    for (uint k = 0u; k < SURFELS_PER_INVOCATION; ++k) {
        uint i = surfel_index(k);
        if (i >= counters.count) return;
        vec4 surfel = position_confidence[i];
        vec3 p = transform(T_camera_world, surfel.xyz);
        if (surfel.w < params.predict_confidence || surfel.w <= 0.0 || p.z < NEAR_PLANE) continue;
        vec2 centre = project(c, p);
        if (centre.x < -MAX_DISC_EXTENT || centre.y < -MAX_DISC_EXTENT ||
            centre.x > float(c.width) + MAX_DISC_EXTENT || centre.y > float(c.height) + MAX_DISC_EXTENT) continue;
        vec4 shape = normal_radius[i];
        vec3 normal = rotate(T_camera_world, shape.xyz);
        if (dot(normal, p) >= 0.0) continue;  // seen from behind
        if ((appearance[i][LAST_SEEN] < params.active_since) != (params.inactive_only != 0u)) continue;
        float extent = min(shape.w * max(c.fx, c.fy) / p.z, MAX_DISC_EXTENT);
        ivec2 low = max(ivec2(ceil(centre - extent)), ivec2(0));
        ivec2 high = min(ivec2(floor(centre + extent)), ivec2(c.width, c.height) - 1);
        for (int v = low.y; v <= high.y; ++v) {
            for (int u = low.x; u <= high.x; ++u) {
                vec2 hit = disc_hit(c, vec2(u, v), p, normal, shape.w);
                if (hit.x > 0.0) {
                    uint key = disc_key(hit);
                    DEPTH_TEST(uint(v) * c.width + uint(u), key, i);
                }
            }
        }
    }
}
