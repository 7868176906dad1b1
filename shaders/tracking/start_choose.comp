#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/se3.glsl"
// Which of two starts tracking takes: its own pre-alignment, or one found by other means. They are compared, by their
// residuals at the coarsest level, only where they are too far apart for tracking to find the one from the other.
// Three steps, the reduction (track_reduce) between them:
//   0  model_live is the pre-alignment: does the other start matter?
//   1  rows of the pre-alignment: its cost; model_live becomes the other start
//   2  rows of the other start: its cost; model_live becomes the better one
// push: step, workgroups of the reduction
layout(push_constant) uniform Push { uint step; uint groups; };
readonly buffer ParamsBuffer { Params params; };
readonly buffer Rows { float rows[]; };
readonly buffer RowCounts { uint row_counts[]; };
buffer Record { TrackingRecord record; };
buffer Start { StartRecord start; };
writeonly buffer Arguments { DispatchArguments arguments[]; };
#include "include/row_sum.glsl"

// Mean residual of a live pixel, standard deviations: geometric plus photometric.
float cost_of_rows() {
    float live = sums[COLUMN_LIVE], met = sums[COLUMN_ICP_COUNT], shaded = sums[COLUMN_PHOTOMETRIC_COUNT];
    float geometric = sums[COLUMN_ICP_ABS] + START_OUTLIER_SIGMAS * (live - met);
    float photometric = sums[COLUMN_PHOTOMETRIC_ABS] / FIRST_PHOTOMETRIC_SCALE;
    return geometric / max(live, 1.0) + photometric / max(shaded, 1.0);
}

void main() {
    if (step > 0u) add_rows(groups);
    if (gl_LocalInvocationID.x != 0u) return;
    if (step == 0u) {
        Pose between = compose(inverse_pose(record.model_live), start.model_live);
        float pixels = params.fx * (abs(rotation_angle(between)) + length(translation(between)) / START_DEPTH);
        bool matters = start.known != 0u && pixels > MIN_START_PIXELS;
        arguments[START_SLOT] = DispatchArguments(matters ? groups : 0u, 1u, 1u);
        arguments[START_SLOT + 1u] = DispatchArguments(matters ? 1u : 0u, 1u, 1u);
        start.used = 0u;
        start.own_cost = start.cost = 0.0;
    } else if (step == 1u) {
        start.own_cost = cost_of_rows();
        record.model_live = start.model_live;
    } else {
        start.cost = cost_of_rows();
        start.used = start.cost < start.own_cost ? 1u : 0u;
        if (start.used == 0u) record.model_live = record.so3_best;
    }
}
