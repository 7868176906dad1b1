// Sums of normal equations. Each invocation adds up many pixels in registers, the subgroup adds its lanes, and each
// subgroup writes ONE row; the solving kernel adds the rows in a fixed order, so the result does not depend on threads.
// No subgroup size is assumed: a workgroup has room for REDUCTION_MAX_ROWS rows and counts those it wrote.
#ifndef POSEFUSION_REDUCTION
#define POSEFUSION_REDUCTION
#include "shared_constants.h"

// Where the row of this subgroup begins in the buffer `float rows[]`.
#define REDUCTION_ROW_OF(columns) ((gl_WorkGroupID.x * REDUCTION_MAX_ROWS + gl_SubgroupID) * (columns))
#define REDUCTION_ROW REDUCTION_ROW_OF(REDUCTION_COLUMNS)

// H += w J J^T (upper triangle), g += w J r. Literal indices keep all 27 sums in registers.
#define ACCUMULATE_6(H, J, w, r)                                                                                      \
    {                                                                                                                 \
        float wj0 = (w) * J[0], wj1 = (w) * J[1], wj2 = (w) * J[2];                                                   \
        float wj3 = (w) * J[3], wj4 = (w) * J[4], wj5 = (w) * J[5];                                                   \
        H[0] += wj0 * J[0]; H[1] += wj0 * J[1]; H[2] += wj0 * J[2];                                                   \
        H[3] += wj0 * J[3]; H[4] += wj0 * J[4]; H[5] += wj0 * J[5];                                                   \
        H[6] += wj1 * J[1]; H[7] += wj1 * J[2]; H[8] += wj1 * J[3]; H[9] += wj1 * J[4]; H[10] += wj1 * J[5];          \
        H[11] += wj2 * J[2]; H[12] += wj2 * J[3]; H[13] += wj2 * J[4]; H[14] += wj2 * J[5];                           \
        H[15] += wj3 * J[3]; H[16] += wj3 * J[4]; H[17] += wj3 * J[5];                                                \
        H[18] += wj4 * J[4]; H[19] += wj4 * J[5];                                                                     \
        H[20] += wj5 * J[5];                                                                                          \
        H[21] += wj0 * (r); H[22] += wj1 * (r); H[23] += wj2 * (r);                                                   \
        H[24] += wj3 * (r); H[25] += wj4 * (r); H[26] += wj5 * (r);                                                   \
    }

// What depends on a turn about the axes of the model's camera: (pose, turn), (turn, turn) and gradient; then what
// depends on its acceleration, with the square of the time for its half: (translation, acceleration), (turn,
// acceleration), (acceleration, acceleration) and gradient. wt = w time.
#define ACCUMULATE_TURN(sums, J, wt, time, r)                                                                         \
    {                                                                                                                 \
        float t3 = (wt) * J[3], t4 = (wt) * J[4], t5 = (wt) * J[5];                                                   \
        sums[0] += t3 * J[0]; sums[1] += t4 * J[0]; sums[2] += t5 * J[0];                                             \
        sums[3] += t3 * J[1]; sums[4] += t4 * J[1]; sums[5] += t5 * J[1];                                             \
        sums[6] += t3 * J[2]; sums[7] += t4 * J[2]; sums[8] += t5 * J[2];                                             \
        sums[9] += t3 * J[3]; sums[10] += t4 * J[3]; sums[11] += t5 * J[3];                                           \
        sums[12] += t3 * J[4]; sums[13] += t4 * J[4]; sums[14] += t5 * J[4];                                          \
        sums[15] += t3 * J[5]; sums[16] += t4 * J[5]; sums[17] += t5 * J[5];                                          \
        float s3 = (time) * t3, s4 = (time) * t4, s5 = (time) * t5;                                                   \
        sums[18] += s3 * J[3]; sums[19] += s3 * J[4]; sums[20] += s3 * J[5];                                          \
        sums[21] += s4 * J[4]; sums[22] += s4 * J[5];                                                                 \
        sums[23] += s5 * J[5];                                                                                        \
        sums[24] += t3 * (r); sums[25] += t4 * (r); sums[26] += t5 * (r);                                             \
        sums[27] += s3 * J[0]; sums[28] += s4 * J[0]; sums[29] += s5 * J[0];                                          \
        sums[30] += s3 * J[1]; sums[31] += s4 * J[1]; sums[32] += s5 * J[1];                                          \
        sums[33] += s3 * J[2]; sums[34] += s4 * J[2]; sums[35] += s5 * J[2];                                          \
        float c3 = (time) * s3, c4 = (time) * s4, c5 = (time) * s5;                                                   \
        sums[36] += c3 * J[3]; sums[37] += c3 * J[4]; sums[38] += c3 * J[5];                                          \
        sums[39] += c4 * J[4]; sums[40] += c4 * J[5];                                                                 \
        sums[41] += c5 * J[5];                                                                                        \
        float f3 = (time) * c3, f4 = (time) * c4, f5 = (time) * c5;                                                   \
        sums[42] += f3 * J[3]; sums[43] += f3 * J[4]; sums[44] += f3 * J[5];                                          \
        sums[45] += f4 * J[4]; sums[46] += f4 * J[5];                                                                 \
        sums[47] += f5 * J[5];                                                                                        \
        sums[48] += s3 * (r); sums[49] += s4 * (r); sums[50] += s5 * (r);                                             \
    }

#endif
