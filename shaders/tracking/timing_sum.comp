#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_constants.h"
#define ROW_COLUMNS TIMING_COLUMNS
// Adds the rows of track_reduce with TIMING.
// push: workgroups of the reduction
// out: timing_sums [TIMING_COLUMNS]
layout(push_constant) uniform Push { uint groups; };
readonly buffer Rows { float rows[]; };
readonly buffer RowCounts { uint row_counts[]; };
writeonly buffer TimingSums { float timing_sums[]; };
#include "include/row_sum.glsl"

void main() {
    add_rows(groups);
    uint column = gl_LocalInvocationID.x;
    if (column < TIMING_COLUMNS) timing_sums[column] = sums[column];
}
