// Adds the rows that the workgroups of a reduction wrote, in a fixed order. Needs the buffers `float rows[]` and
// `uint row_counts[]`; leaves the sums in shared memory, `sums`. One workgroup: slices of the rows, and within a slice
// one invocation per column.
#ifndef POSEFUSION_ROW_SUM
#define POSEFUSION_ROW_SUM
#include "shared_constants.h"

// Columns of a row; define it before to add other rows.
#ifndef ROW_COLUMNS
#define ROW_COLUMNS REDUCTION_COLUMNS
#endif

const uint LANES = ROW_COLUMNS > 64u ? 128u : 64u;
const uint SLICES = 256u / LANES;
layout(local_size_x = SLICES * LANES) in;

shared float slices[SLICES * LANES];
shared float sums[LANES];

void add_rows(uint groups) {
    uint column = gl_LocalInvocationID.x % LANES;
    uint slice = gl_LocalInvocationID.x / LANES;
    float sum = 0.0;
    if (column < ROW_COLUMNS) {
        for (uint g = slice; g < groups; g += SLICES) {
            uint base = g * REDUCTION_MAX_ROWS;
            uint count = row_counts[g];
            for (uint r = 0u; r < count; ++r) sum += rows[(base + r) * ROW_COLUMNS + column];
        }
    }
    slices[slice * LANES + column] = sum;
    barrier();
    if (slice == 0u) {
        float sum = 0.0;
        for (uint k = 0u; k < SLICES; k += 2u) sum += slices[k * LANES + column] + slices[(k + 1u) * LANES + column];
        sums[column] = sum;
    }
    barrier();
}

#endif
