#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/geometry.glsl"
#include "include/se3.glsl"
#include "include/surfel.glsl"
#include "include/depth_test.glsl"
// Prediction, first half: every confident surfel of the active model (or of the inactive one) drawn as its disc; per pixel the best of the nearest surface wins.
// in:  surfel positions, normals and times, view pose (record.world_live of the bound record), counters.count
// out: cells [n], cleared to 0xff before
layout(local_size_x = 256) in;
layout(push_constant) uniform Push { uint pass; };
readonly buffer ParamsBuffer { Params params; };
readonly buffer Record { TrackingRecord record; };
readonly buffer Counters { MapRecord counters; };
readonly buffer Positions { vec4 position_confidence[]; };
readonly buffer Normals { vec4 normal_radius[]; };
readonly buffer Appearances { uvec4 appearance[]; };
DEPTH_TEST_BUFFERS
#include "include/disc.glsl"

const float MAX_EXTENT = 12.0;  // pixels; nearer discs are cut, their neighbours cover the rest

void main() {
    Camera c = camera_at(params, 0u);
    Pose T_camera_world = inverse_pose(record.world_live);
    for (uint k = 0u; k < 4u; ++k) {
        uint i = (gl_WorkGroupID.x * 4u + k) * 256u + gl_LocalInvocationID.x;
        if (i >= counters.count) return;
        vec4 surfel = position_confidence[i];
        vec3 p = transform(T_camera_world, surfel.xyz);
        if (surfel.w < params.predict_confidence || surfel.w <= 0.0 || p.z < 0.1) continue;
        vec2 centre = project(c, p);
        if (centre.x < -MAX_EXTENT || centre.y < -MAX_EXTENT || centre.x > float(c.width) + MAX_EXTENT ||
            centre.y > float(c.height) + MAX_EXTENT) continue;
        vec4 shape = normal_radius[i];
        vec3 normal = rotate(T_camera_world, shape.xyz);
        if (dot(normal, p) >= 0.0) continue;  // seen from behind
        if ((appearance[i].w < params.active_since) != (params.inactive_only != 0u)) continue;
        float extent = min(shape.w * max(c.fx, c.fy) / p.z, MAX_EXTENT);
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
