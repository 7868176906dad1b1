#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/mask.glsl"
// Dilation of the bit mask by a disc of radius params.dilation, less than MASK_WORD pixels.
// in:  mask    [words per row * height]
// out: dilated_mask [words per row * height]
layout(local_size_x = GROUP) in;
readonly buffer ParamsBuffer { Params params; };
readonly buffer Mask { uint mask[]; };
writeonly buffer DilatedMask { uint dilated_mask[]; };

void main() {
    uint row_words = mask_row_words(params.width);
    uint word = gl_GlobalInvocationID.x;
    if (word >= row_words * params.height) return;
    int v = int(word / row_words);
    uint column = word - uint(v) * row_words;
    int r = int(params.dilation);
    uint result = 0u;
    for (int dv = -r; dv <= r; ++dv) {
        int row = v + dv;
        if (row < 0 || row >= int(params.height)) continue;
        uint base = uint(row) * row_words + column;
        uint here = mask[base];
        uint left = column > 0u ? mask[base - 1u] : 0u;
        uint right = column + 1u < row_words ? mask[base + 1u] : 0u;
        int reach = int(sqrt(float(r * r - dv * dv) + 0.5));  // whole part, also where sqrt(25) is 4.9999
        result |= here;
        for (int du = 1; du <= reach; ++du) {
            int rest = int(MASK_WORD) - du;
            result |= (here << du) | (left >> rest) | (here >> du) | (right << rest);
        }
    }
    dilated_mask[word] = result;
}
