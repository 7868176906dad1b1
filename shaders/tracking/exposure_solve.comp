#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
// The exposure of the frame: per channel the ratio of the weighted means of model and live image. Unlike a fitted slope
// it is not drawn towards 0 by the noise of the live image, so that the colours of the map keep their contrast.
// push: workgroups of the reduction
layout(push_constant) uniform Push { uint groups; };
readonly buffer Rows { float rows[]; };
readonly buffer RowCounts { uint row_counts[]; };
buffer Record { TrackingRecord record; };
#include "include/row_sum.glsl"

void main() {
    add_rows(groups);
    if (gl_LocalInvocationID.x != 0u) return;
    if (record.failed != 0u || sums[COLUMN_EXPOSURE_WEIGHT] < MIN_EXPOSURE_PIXELS) return;
    for (uint channel = 0u; channel < 3u; ++channel) {
        float live = sums[COLUMN_EXPOSURE_LIVE + channel], model = sums[COLUMN_EXPOSURE_MODEL + channel];
        if (live > 0.0 && model > 0.0) {
            record.exposure[channel] = clamp(model / live, 1.0 / MAX_EXPOSURE, MAX_EXPOSURE);
        }
    }
}
