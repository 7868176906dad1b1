#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/se3.glsl"
#include "include/shutter.glsl"
// One Gauss-Newton step: sums the rows, solves the 6x6 system, updates the estimate. Ends its level (by zeroing its own
// dispatch arguments) when the step is small or the system cannot be solved. Where the start of tracking is known to be
// good (params.prior_...), a Gaussian around it is one more residual: what the image does not fix stays there. A
// motion that is expected (params.steady_...) decides how far the camera moves in directions that the image does not
// fix, as along a bare wall.
// push: workgroups of the reduction, slot of its dispatch arguments, its step (what is counted stands for all pixels)
layout(push_constant) uniform Push { uint groups; uint slot; uint step; };
readonly buffer ParamsBuffer { Params params; };
readonly buffer Rows { float rows[]; };
readonly buffer RowCounts { uint row_counts[]; };
buffer Record { TrackingRecord record; };
writeonly buffer Arguments { DispatchArguments arguments[]; };
#include "include/row_sum.glsl"
#include "include/solve.glsl"

// r = M c - c, J = [I, -[c]x] with c the middle of what is tracked; and the turn. Weights 1/m^2, 1/rad^2.
void add_prior(inout float A[UNKNOWNS * UNKNOWNS], inout float b[UNKNOWNS], float weight, float turn_weight) {
    vec3 c = vec3(params.prior_x, params.prior_y, params.prior_z);
    vec3 shift = transform(record.model_live, c) - c, turn = log_rotation(record.model_live);
    for (int axis = 0; axis < 3; ++axis) {
        vec3 e = vec3(axis == 0, axis == 1, axis == 2);
        vec3 moment = cross(c, e);
        float J[UNKNOWNS] = float[UNKNOWNS](e.x, e.y, e.z, moment.x, moment.y, moment.z);
        for (int i = 0; i < UNKNOWNS; ++i) {
            for (int j = 0; j < UNKNOWNS; ++j) A[i * UNKNOWNS + j] += weight * J[i] * J[j];
            b[i] -= weight * J[i] * shift[axis];
        }
        A[(axis + 3) * UNKNOWNS + axis + 3] += turn_weight;
        b[axis + 3] -= turn_weight * turn[axis];
    }
}

// Before a known surface so many of the live pixels are inliers, and more; before another one fewer.
const float RECOGNISED = 0.8;

// Where the camera moves to: r = t - e with e the shift that is expected. The weight of a direction is full where the
// image says nothing of it and falls as the square where it says much; by matrices that holds in their eigenvectors.
// Only before a surface that is recognised: nothing may make the pose of a lost camera look plausible.
void add_expected_shift(inout float A[UNKNOWNS * UNKNOWNS], inout float b[UNKNOWNS]) {
    mat3 image;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) image[j][i] = A[i * UNKNOWNS + j];
    float mean = (image[0][0] + image[1][1] + image[2][2]) / 3.0;
    if (!(mean > 0.0)) return;
    mat3 unknown = inverse(mat3(1.0) + image / (params.steady_enough * mean));
    mat3 weight = (params.steady_floor + params.steady_share * mean) * unknown * unknown;
    vec3 pull = weight * (translation(record.model_live) - shift_after(record.expected_motion, params.interval));
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) A[i * UNKNOWNS + j] += weight[j][i];
        b[i] -= pull[i];
    }
}

void main() {
    add_rows(groups);
    if (gl_LocalInvocationID.x != 0u) return;
    record.iterations += 1u;
    record.icp_inliers = uint(sums[COLUMN_ICP_COUNT]) * step;
    record.photometric_inliers = uint(sums[COLUMN_PHOTOMETRIC_COUNT]) * step;
    for (uint i = 0u; i < COLUMN_GRADIENT; ++i) record.hessian[i] = sums[i];

    float A[UNKNOWNS * UNKNOWNS];
    float b[UNKNOWNS];
    float x[UNKNOWNS];
    int k = 0;
    for (int i = 0; i < UNKNOWNS; ++i) {
        for (int j = i; j < UNKNOWNS; ++j) {
            A[i * UNKNOWNS + j] = sums[k];
            A[j * UNKNOWNS + i] = sums[k];
            ++k;
        }
        b[i] = -sums[COLUMN_GRADIENT + i];
    }
    if (params.prior_share + params.prior_floor > 0.0) {
        float mean = (A[0] + A[UNKNOWNS + 1] + A[2 * UNKNOWNS + 2]) / 3.0;
        float known = params.prior_share * mean + params.prior_floor;
        add_prior(A, b, known, known * params.prior_radius * params.prior_radius);
    }
    bool recognised = sums[COLUMN_ICP_COUNT] >= RECOGNISED * sums[COLUMN_LIVE];
    if (params.steady_floor > 0.0 && record.expected_motion.translation.w > 0.0 && recognised) add_expected_shift(A, b);
    bool solved = solve_spd(A, b, UNKNOWNS, x);
    vec3 v = vec3(x[0], x[1], x[2]), w = vec3(x[3], x[4], x[5]);
    if (solved) record.model_live = orthonormalised(compose(exp_pose(v, w), record.model_live));

    Twist motion = with_turn(mean_motion(record.model_live, params.interval), record.turn_offset);
    record.motion_error = sum(motion, scaled(record.expected_motion, -1.0));

    record.valid_pixels = uint(sums[COLUMN_LIVE]) * step;

    // scales for the next step
    float icp_count = sums[COLUMN_ICP_COUNT], photometric_count = sums[COLUMN_PHOTOMETRIC_COUNT];
    if (icp_count > 0.0) {
        record.icp_scale =
            clamp(SIGMA_PER_MEAN_ABS * sums[COLUMN_ICP_ABS] / icp_count, MIN_ICP_SCALE, MAX_ICP_SCALE);
        record.icp_rmse = sqrt(sums[COLUMN_ICP_SQUARES] / icp_count);
    }
    if (photometric_count > 0.0) {
        record.photometric_scale = clamp(SIGMA_PER_MEAN_ABS * sums[COLUMN_PHOTOMETRIC_ABS] / photometric_count,
                                         MIN_PHOTOMETRIC_SCALE, MAX_PHOTOMETRIC_SCALE);
        // the ratio of the means: unlike a fitted slope it is not drawn towards 0 by the noise of the live image
        float live = sums[COLUMN_LIVE_INTENSITY], model = sums[COLUMN_MODEL_INTENSITY];
        if (live > 0.0) record.photometric_gain = clamp(model / live, 1.0 / MAX_GAIN, MAX_GAIN);
        record.photometric_rmse = sqrt(sums[COLUMN_PHOTOMETRIC_SQUARES] / photometric_count);
    }

    bool converged = solved && dot(v, v) < params.converged_translation * params.converged_translation &&
                     dot(w, w) < params.converged_rotation * params.converged_rotation;
    if (!solved || converged) {
        arguments[slot].x = 0u;
        arguments[slot + 1u].x = 0u;
    }
}
