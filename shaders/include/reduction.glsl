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

#endif
