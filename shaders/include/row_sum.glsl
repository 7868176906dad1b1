// Adds the rows that the workgroups of a reduction wrote, in a fixed order, with one workgroup of 256 invocations.
// Needs buffers `float rows[]` and `uint row_counts[]`; leaves the sums in shared memory `sums`.
#ifndef POSEFUSION_ROW_SUM
#define POSEFUSION_ROW_SUM

shared float slices[4 * 64];
shared float sums[64];

void add_rows(uint groups) {
    uint column = gl_LocalInvocationID.x & 63u;
    uint slice = gl_LocalInvocationID.x >> 6;
    float sum = 0.0;
    if (column < REDUCTION_COLUMNS) {
        for (uint g = slice; g < groups; g += 4u) {
            uint base = g * REDUCTION_MAX_ROWS;
            uint count = row_counts[g];
            for (uint r = 0u; r < count; ++r) sum += rows[(base + r) * REDUCTION_COLUMNS + column];
        }
    }
    slices[slice * 64u + column] = sum;
    barrier();
    if (slice == 0u) sums[column] = (slices[column] + slices[64u + column]) + (slices[128u + column] + slices[192u + column]);
    barrier();
}

#endif
