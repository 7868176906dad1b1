#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
// Person labels -> one bit per pixel. A word holds 32 pixels of a row; a row has ceil(width / 32) words.
// in:  color   [width * height] r | g << 8 | b << 16 | label << 24
// out: mask    [words per row * height]
layout(local_size_x = 64) in;
readonly buffer ParamsBuffer { Params params; };
readonly buffer Color { uint color[]; };
writeonly buffer Mask { uint mask[]; };

void main() {
    uint row_words = (params.width + 31u) / 32u;
    uint word = gl_GlobalInvocationID.x;
    if (word >= row_words * params.height) return;
    uint v = word / row_words;
    uint u0 = (word - v * row_words) * 32u;
    uint bits = 0u;
    for (uint i = 0u; i < 32u; ++i) {
        uint u = min(u0 + i, params.width - 1u);
        bits |= uint((color[v * params.width + u] >> 24) != 0u) << i;
    }
    mask[word] = bits;
}
