#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/se3.glsl"
#include "include/shutter.glsl"
// Starts a frame: the model was predicted from the last pose; sets the dispatch arguments of every iteration.
// push: workgroups of the reductions of SO(3) and of each level
layout(local_size_x = 1) in;
layout(push_constant) uniform Push { uint so3_groups; uint level_groups[LEVELS]; };
buffer Record { TrackingRecord record; };
writeonly buffer Arguments { DispatchArguments arguments[]; };

void main() {
    record.world_model = record.world_live;
    record.model_live = identity_pose();
    record.so3 = identity_pose();
    record.so3_best = identity_pose();
    record.so3_error = UNBOUNDED;
    record.motion_error = no_motion();
    record.turn_offset = record.turn_acceleration = vec4(0.0);
    record.icp_scale = FIRST_ICP_SCALE;
    record.photometric_scale = FIRST_PHOTOMETRIC_SCALE;
    record.photometric_gain = 1.0;
    record.failed = 0u;
    record.icp_rmse = 0.0;
    record.photometric_rmse = 0.0;
    record.icp_inliers = 0u;
    record.photometric_inliers = 0u;
    record.valid_pixels = 0u;
    record.iterations = 0u;
    arguments[SO3_SLOT] = DispatchArguments(so3_groups, 1u, 1u);
    arguments[SO3_SLOT + 1u] = DispatchArguments(1u, 1u, 1u);
    for (uint level = 0u; level < LEVELS; ++level) {
        uint slot = FIRST_LEVEL_SLOT + SLOTS_PER_LEVEL * level;
        arguments[slot] = DispatchArguments(level_groups[level], 1u, 1u);
        arguments[slot + 1u] = DispatchArguments(1u, 1u, 1u);
    }
}
