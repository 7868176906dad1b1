#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/se3.glsl"
// One Gauss-Newton step of the rotation-only pre-alignment. Keeps the best rotation so far; ends the iteration (by
// zeroing its own dispatch arguments) when the error has stopped falling.
// push: workgroups of the reduction, slot of its dispatch arguments
layout(push_constant) uniform Push { uint groups; uint slot; };
readonly buffer Rows { float rows[]; };
readonly buffer RowCounts { uint row_counts[]; };
buffer Record { TrackingRecord record; };
writeonly buffer Arguments { DispatchArguments arguments[]; };
#include "include/row_sum.glsl"
#include "include/solve.glsl"

void stop() {
    arguments[slot].x = 0u;
    arguments[slot + 1u].x = 0u;
}

void main() {
    add_rows(groups);
    if (gl_LocalInvocationID.x != 0u) return;
    float count = sums[COLUMN_SO3_COUNT];
    float error = count > 0.0 ? sqrt(sums[COLUMN_SO3_SQUARES] / count) : UNBOUNDED;
    if (count < MIN_SO3_PIXELS || error > record.so3_error * SO3_IMPROVEMENT) {  // no better: the best so far stays
        stop();
        return;
    }
    record.so3_error = error;
    record.so3_best = record.so3;
    float A[UNKNOWNS * UNKNOWNS];
    float b[UNKNOWNS];
    float x[UNKNOWNS];
    for (int i = 0; i < UNKNOWNS * UNKNOWNS; ++i) A[i] = 0.0;
    A[0] = sums[0], A[1] = sums[1], A[2] = sums[2];  // rows of six, of which three are used
    A[UNKNOWNS] = sums[1], A[UNKNOWNS + 1] = sums[3], A[UNKNOWNS + 2] = sums[4];
    A[2 * UNKNOWNS] = sums[2], A[2 * UNKNOWNS + 1] = sums[4], A[2 * UNKNOWNS + 2] = sums[5];
    for (int i = 0; i < 3; ++i) b[i] = -sums[COLUMN_SO3_GRADIENT + i];
    if (!solve_spd(A, b, 3, x)) {
        stop();
        return;
    }
    record.so3 = orthonormalised(compose(exp_pose(vec3(0.0), vec3(x[0], x[1], x[2])), record.so3));
}
