#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/geometry.glsl"
#include "include/se3.glsl"
#include "include/reduction.glsl"
// One Gauss-Newton step: adds the rows, solves the 6x6 system, moves the estimate. Ends its level (by zeroing its own
// dispatch arguments) when the step is small or the system cannot be solved.
// push: workgroups of the reduction, slot of this level's dispatch arguments, step of the reduction (counts are of all pixels)
layout(local_size_x = 256) in;
layout(push_constant) uniform Push { uint groups; uint slot; uint step; };
readonly buffer ParamsBuffer { Params params; };
readonly buffer Rows { float rows[]; };
readonly buffer RowCounts { uint row_counts[]; };
buffer Record { TrackingRecord record; };
writeonly buffer Arguments { DispatchArguments arguments[]; };
#include "include/row_sum.glsl"
#include "include/solve.glsl"

const float MEAN_ABS_TO_SIGMA = 1.2533;  // sqrt(pi / 2), for a normal distribution

void main() {
    add_rows(groups);
    if (gl_LocalInvocationID.x != 0u) return;
    record.iterations += 1u;
    record.icp_inliers = uint(sums[28]) * step;
    record.photometric_inliers = uint(sums[31]) * step;
    for (int i = 0; i < 21; ++i) record.hessian[i] = sums[i];

    float A[36];
    float b[6];
    float x[6];
    int k = 0;
    for (int i = 0; i < 6; ++i) {
        for (int j = i; j < 6; ++j) {
            A[i * 6 + j] = sums[k];
            A[j * 6 + i] = sums[k];
            ++k;
        }
        b[i] = -sums[21 + i];
    }
    bool solved = solve_spd(A, b, 6, x);
    vec3 v = vec3(x[0], x[1], x[2]), w = vec3(x[3], x[4], x[5]);
    if (solved) record.model_live = orthonormalised(compose(exp_pose(v, w), record.model_live));

    record.valid_pixels = uint(sums[34]) * step;

    // scales for the next step
    if (sums[28] > 0.0) {
        record.icp_scale = clamp(MEAN_ABS_TO_SIGMA * sums[27] / sums[28], 0.5, 4.0);
        record.icp_rmse = sqrt(sums[29] / sums[28]);
    }
    if (sums[31] > 0.0) {
        record.photometric_scale = clamp(MEAN_ABS_TO_SIGMA * sums[30] / sums[31], 0.008, 0.2);
        record.photometric_bias = sums[33] / sums[31];
        record.photometric_rmse = sqrt(sums[32] / sums[31]);
    }

    bool converged = solved && dot(v, v) < params.converged_translation * params.converged_translation &&
                     dot(w, w) < params.converged_rotation * params.converged_rotation;
    if (!solved || converged) {
        arguments[slot].x = 0u;
        arguments[slot + 1u].x = 0u;
    }
}
