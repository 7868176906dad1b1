#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/se3.glsl"
// Judges the tracking of this frame. Good: the pose moves on, the fusion weight follows the camera's speed (a fast
// camera blurs). Bad (few inliers, implausible motion, not finite): the pose is held and nothing is fused.
layout(local_size_x = 1) in;
layout(std430, binding = 0) readonly buffer ParamsBuffer { Params params; };
layout(std430, binding = 1) buffer Record { TrackingRecord record; };

void main() {
    float distance = length(translation(record.model_live));
    float angle = abs(rotation_angle(record.model_live));
    uint inliers = max(record.icp_inliers, record.photometric_inliers);
    bool enough = float(inliers) >= params.min_inlier_ratio * float(record.valid_pixels) &&
                  float(inliers) >= params.min_inlier_ratio * 0.1 * float(params.width * params.height);
    bool plausible = is_finite(record.model_live) && distance <= params.max_step_translation && angle <= params.max_step_rotation;
    if (enough && plausible) {
        record.world_live = orthonormalised(compose(record.world_model, record.model_live));
        record.fusion_weight = max(1.0 - max(distance, angle) / params.speed_scale, 0.5);
    } else {
        record.failed = 1u;
        record.model_live = identity_pose();
        record.world_live = record.world_model;
        record.fusion_weight = 0.0;
    }
}
