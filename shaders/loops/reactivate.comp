#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/association.glsl"
#include "include/geometry.glsl"
#include "include/per_surfel.glsl"
#include "include/se3.glsl"
// After a loop has been closed, the inactive surfels in view are what the camera sees: they are reactivated. Active
// surfels that were added over them since the camera returned duplicate the same surface: they are removed.
// in:  inactive_depth [n] of the inactive model predicted at record.world_model, close to record.world_live
readonly buffer ParamsBuffer { Params params; };
readonly buffer Record { TrackingRecord record; };
readonly buffer Counters { MapRecord counters; };
readonly buffer InactiveDepth { float inactive_depth[]; };
buffer Positions { vec4 position_confidence[]; };
buffer Appearances { uvec4 appearance[]; };

void main() {
    Camera c = camera_at(params, 0u);
    Pose T_camera_world = inverse_pose(record.world_live);
    for (uint k = 0u; k < SURFELS_PER_INVOCATION; ++k) {
        uint i = surfel_index(k);
        if (i >= counters.count) return;
        vec4 surfel = position_confidence[i];
        vec3 p = transform(T_camera_world, surfel.xyz);
        if (surfel.w <= 0.0 || p.z < NEAR_PLANE) continue;
        ivec2 uv = nearest_pixel(c, project(c, p));
        if (!in_image(c, uv)) continue;
        float model = inactive_depth[index_of(c, uv)];
        if (model <= 0.0) continue;
        if (abs(p.z - model) >= association_gate(params, p.z)) continue;
        if (appearance[i][LAST_SEEN] >= params.active_since) {
            if (appearance[i][CREATED] >= params.active_since) position_confidence[i].w = 0.0;
        } else if (surfel.w >= params.stable_confidence) {
            appearance[i][LAST_SEEN] = params.frame;
        }
    }
}
