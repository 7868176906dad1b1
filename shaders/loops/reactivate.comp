#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/geometry.glsl"
#include "include/se3.glsl"
// After a loop was closed the inactive surfels in view are what the camera sees: they become active again. What the active
// model has laid over them since the camera came back is the same surface a second time: it is removed.
// in:  inactive_depth [n] of the inactive model predicted at record.world_model, close to record.world_live
layout(local_size_x = 256) in;
readonly buffer ParamsBuffer { Params params; };
readonly buffer Record { TrackingRecord record; };
readonly buffer Counters { MapRecord counters; };
readonly buffer InactiveDepth { float inactive_depth[]; };
buffer Positions { vec4 position_confidence[]; };
buffer Appearances { uvec4 appearance[]; };

void main() {
    Camera c = camera_at(params, 0u);
    Pose T_camera_world = inverse_pose(record.world_live);
    for (uint k = 0u; k < 4u; ++k) {
        uint i = (gl_WorkGroupID.x * 4u + k) * 256u + gl_LocalInvocationID.x;
        if (i >= counters.count) return;
        vec4 surfel = position_confidence[i];
        vec3 p = transform(T_camera_world, surfel.xyz);
        if (surfel.w <= 0.0 || p.z < 0.1) continue;
        ivec2 uv = ivec2(floor(clamp(project(c, p), vec2(-2.0), vec2(c.width, c.height) + 2.0) + 0.5));
        if (!in_image(c, uv)) continue;
        float model = inactive_depth[uv.y * int(c.width) + uv.x];
        if (model <= 0.0) continue;
        float gate = max(params.association_depth, params.association_sigmas * depth_sigma(params, p.z));
        bool near_model = abs(p.z - model) < gate;
        if (!near_model) continue;
        if (appearance[i].w >= params.active_since) {
            if (appearance[i].z >= params.active_since) position_confidence[i].w = 0.0;
        } else if (surfel.w >= params.stable_confidence) {
            appearance[i].w = params.frame;
        }
    }
}
