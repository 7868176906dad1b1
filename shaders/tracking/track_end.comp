#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/se3.glsl"
#include "include/shutter.glsl"
#include "include/solve.glsl"
// Judges the tracking of this frame. Good: the pose is updated, the fusion weight follows the camera's speed (a fast
// camera blurs). Bad (few inliers, large residuals, a pose that the view does not fix, implausible motion, not finite):
// the pose is held and nothing is fused.
layout(local_size_x = 1) in;
readonly buffer ParamsBuffer { Params params; };
buffer Record { TrackingRecord record; };

// Largest standard deviations of translation and rotation along the axes: roots of the diagonal of the inverse system.
vec2 pose_sigma() {
    vec2 variance = vec2(0.0);
    for (int axis = 0; axis < UNKNOWNS; ++axis) {
        float A[UNKNOWNS * UNKNOWNS];
        float b[UNKNOWNS] = float[UNKNOWNS](0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        float x[UNKNOWNS];
        int k = 0;
        for (int i = 0; i < UNKNOWNS; ++i) {
            for (int j = i; j < UNKNOWNS; ++j) {
                A[i * UNKNOWNS + j] = record.hessian[k];
                A[j * UNKNOWNS + i] = record.hessian[k];
                ++k;
            }
        }
        b[axis] = 1.0;
        if (!solve_spd(A, b, UNKNOWNS, x)) return vec2(UNBOUNDED);
        variance[axis / 3] = max(variance[axis / 3], x[axis]);
    }
    return sqrt(variance);
}

void main() {
    float distance = length(translation(record.model_live));
    float angle = abs(rotation_angle(record.model_live));
    uint inliers = max(record.icp_inliers, record.photometric_inliers);
    bool enough = float(inliers) >= params.min_inlier_ratio * float(record.valid_pixels) &&
                  float(inliers) >= params.min_inlier_ratio * MIN_LIVE_SHARE * float(params.width * params.height);
    bool plausible = is_finite(record.model_live) && distance <= params.max_step_translation &&
                     angle <= params.max_step_rotation;
    vec2 sigma = pose_sigma();
    bool fixed_by_view = sigma.x <= params.max_translation_sigma && sigma.y <= params.max_rotation_sigma;
    if (enough && plausible && fixed_by_view && record.icp_rmse <= params.max_icp_rmse) {
        record.world_live = orthonormalised(compose(record.world_model, record.model_live));
        Twist motion = mean_motion(record.model_live, params.interval);
        record.frame_motion = sum(record.expected_motion, record.motion_error);
        record.motion_error = sum(motion, scaled(record.frame_motion, -1.0));
        record.expected_motion = next_motion(motion, record.last_motion, record.turn_offset);
        record.last_motion = motion;
        record.fusion_weight = max(1.0 - max(distance, angle) / params.speed_scale, MIN_FUSION_WEIGHT);
    } else {
        record.failed = 1u;
        record.model_live = identity_pose();
        record.world_live = record.world_model;
        record.fusion_weight = 0.0;
        record.frame_motion = record.expected_motion;
        record.turn_acceleration = vec4(0.0);
        record.expected_motion = record.last_motion = no_motion();
        record.turn_bias = record.acceleration_bias = vec4(0.0);
    }
}
