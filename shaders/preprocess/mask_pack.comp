#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/color.glsl"
#include "include/mask.glsl"
// Person labels to one bit per pixel.
// in:  color [n], tagged with the label
// out: mask  [words per row * height]
layout(local_size_x = GROUP) in;
readonly buffer ParamsBuffer { Params params; };
readonly buffer Color { uint color[]; };
writeonly buffer Mask { uint mask[]; };

void main() {
    uint row_words = mask_row_words(params.width);
    uint word = gl_GlobalInvocationID.x;
    if (word >= row_words * params.height) return;
    uint v = word / row_words;
    uint u0 = (word - v * row_words) * MASK_WORD;
    uint bits = 0u;
    for (uint i = 0u; i < MASK_WORD; ++i) {
        uint u = min(u0 + i, params.width - 1u);
        bits |= uint(tag_of(color[v * params.width + u]) != 0u) << i;
    }
    mask[word] = bits;
}
