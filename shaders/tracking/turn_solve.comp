#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/se3.glsl"
#include "include/shutter.glsl"
#define ROW_COLUMNS TURN_COLUMNS
#define SOLVE_UNKNOWNS 12
// One Gauss-Newton step of the pose, of how the camera turns at the stamp, and of how that changes while the rows are
// read. Between two poses a hand-held camera does not turn evenly; the rows of a rolling shutter show how it turns now.
// What they show is held against the map, whose own distortion they would take for a turn; but a camera does not turn
// faster than its poses say all the time, so that the mean of what is found is not believed.
// push: workgroups of the reduction, track_reduce with TURN; last: 1 in the last step, which takes that mean off
// out: record.model_live, turn_offset, turn_acceleration, the biases of both, motion_error
layout(push_constant) uniform Push { uint groups; uint last; };
readonly buffer ParamsBuffer { Params params; };
readonly buffer Rows { float rows[]; };
readonly buffer RowCounts { uint row_counts[]; };
buffer Record { TrackingRecord record; };
#include "include/row_sum.glsl"
#include "include/solve.glsl"

// unknowns: of the pose, of the turn, of its acceleration
const int POSE = 6, TURNS = POSE + 3;

void set(inout float A[UNKNOWNS * UNKNOWNS], int i, int j, float value) {
    A[i * UNKNOWNS + j] = A[j * UNKNOWNS + i] = value;
}

void main() {
    add_rows(groups);
    if (gl_LocalInvocationID.x != 0u || !(params.interval > 0.0)) return;
    float A[UNKNOWNS * UNKNOWNS];
    float b[UNKNOWNS];
    float x[UNKNOWNS];
    uint pose = COLUMN_HESSIAN, both = COLUMN_POSE_TURN, turn = COLUMN_TURN;
    for (int i = 0; i < POSE; ++i) {
        for (int j = i; j < POSE; ++j) A[i * UNKNOWNS + j] = A[j * UNKNOWNS + i] = sums[pose++];
        for (int j = POSE; j < TURNS; ++j) A[i * UNKNOWNS + j] = A[j * UNKNOWNS + i] = sums[both++];
        b[i] = -sums[COLUMN_GRADIENT + i];
    }
    uint translation = COLUMN_TRANSLATION_ACCELERATION;
    for (int i = 0; i < 3; ++i) {
        for (int j = TURNS; j < UNKNOWNS; ++j)
            A[i * UNKNOWNS + j] = A[j * UNKNOWNS + i] = 0.5 * sums[translation++];
        for (int j = i; j < 3; ++j) {
            float squares = sums[turn], cubes = 0.5 * sums[turn - COLUMN_TURN + COLUMN_TURN_ACCELERATION],
                  fourths = 0.25 * sums[turn - COLUMN_TURN + COLUMN_ACCELERATION];
            ++turn;
            set(A, POSE + i, POSE + j, squares);
            set(A, 3 + i, TURNS + j, 0.5 * squares);
            set(A, 3 + j, TURNS + i, 0.5 * squares);
            set(A, POSE + i, TURNS + j, cubes);
            set(A, POSE + j, TURNS + i, cubes);
            set(A, TURNS + i, TURNS + j, fourths);
        }
        b[POSE + i] = -sums[COLUMN_TURN_GRADIENT + i];
        b[TURNS + i] = -0.5 * sums[COLUMN_ACCELERATION_GRADIENT + i];
    }
    // the offset, that is the whole turn less that between the poses, is near its mean; earlier steps have found a part
    Pose T = record.model_live;
    vec3 bias = rotate(T, record.turn_bias.xyz - record.turn_offset.xyz);
    vec3 found = rotate(T, record.turn_acceleration.xyz);
    float rate = 1.0 / params.interval;
    float sigma = 0.5 * params.interval * TURN_ACCELERATION;
    float prior = CORRELATED_PIXELS / (sigma * sigma);
    float steady = CORRELATED_PIXELS / (ROW_ACCELERATION * ROW_ACCELERATION);
    for (int axis = 0; axis < 3; ++axis) {
        int i = axis + 3, j = POSE + axis;
        A[i * UNKNOWNS + i] += prior * rate * rate;
        A[j * UNKNOWNS + j] += prior;
        A[i * UNKNOWNS + j] -= prior * rate;
        A[j * UNKNOWNS + i] -= prior * rate;
        b[i] -= prior * rate * bias[axis];
        b[j] += prior * bias[axis];
        A[(TURNS + axis) * UNKNOWNS + TURNS + axis] += steady;
        b[TURNS + axis] -= steady * found[axis];
    }
    if (!solve_spd(A, b, UNKNOWNS, x)) return;
    vec3 v = vec3(x[0], x[1], x[2]), w = vec3(x[3], x[4], x[5]), turned = vec3(x[6], x[7], x[8]);
    record.model_live = orthonormalised(compose(exp_pose(v, w), T));
    Pose to_live = inverse_pose(T);
    record.turn_offset.xyz += rotate(to_live, turned - rate * w);
    record.turn_acceleration.xyz += rotate(to_live, vec3(x[9], x[10], x[11]));
    if (last != 0u) {
        record.turn_offset -= record.turn_bias;
        record.turn_acceleration -= record.acceleration_bias;
        record.turn_bias += TURN_BIAS_SHARE * record.turn_offset;
        record.acceleration_bias += TURN_BIAS_SHARE * record.turn_acceleration;
    }
    Twist motion = with_turn(mean_motion(record.model_live, params.interval), record.turn_offset);
    record.motion_error = sum(motion, scaled(record.expected_motion, -1.0));
}
