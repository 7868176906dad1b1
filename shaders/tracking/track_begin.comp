#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/se3.glsl"
// Starts a frame: the model was predicted from the last pose; sets the dispatch arguments of every iteration.
// push: workgroups of the reductions: SO(3), then levels 0, 1, 2
layout(local_size_x = 1) in;
layout(push_constant) uniform Push { uint so3_groups; uint level_groups[3]; };
buffer Record { TrackingRecord record; };
writeonly buffer Arguments { DispatchArguments arguments[]; };

void main() {
    record.world_model = record.world_live;
    record.model_live = identity_pose();
    record.so3 = identity_pose();
    record.so3_best = identity_pose();
    record.so3_error = 1e9;
    record.icp_scale = 1.0;
    record.photometric_scale = 0.05;
    record.photometric_bias = 0.0;
    record.failed = 0u;
    record.icp_rmse = 0.0;
    record.photometric_rmse = 0.0;
    record.icp_inliers = 0u;
    record.photometric_inliers = 0u;
    record.valid_pixels = 0u;
    record.iterations = 0u;
    arguments[0] = DispatchArguments(so3_groups, 1u, 1u);
    arguments[1] = DispatchArguments(1u, 1u, 1u);
    for (int level = 0; level < 3; ++level) {
        arguments[2 + 2 * level] = DispatchArguments(level_groups[level], 1u, 1u);
        arguments[3 + 2 * level] = DispatchArguments(1u, 1u, 1u);
    }
}
