// Packed pixels: r | g << 8 | b << 16 | tag << 24. The tag is the person label of an input image (0: no person) and the
// source of a predicted one (SOURCE_*).
#ifndef POSEFUSION_COLOR
#define POSEFUSION_COLOR
#include "shared_constants.h"

// 0..1
vec3 unpack_color(uint pixel) {
    return unpackUnorm4x8(pixel).rgb;
}

uint tag_of(uint pixel) {
    return pixel >> 24;
}

uint with_tag(uint pixel, uint tag) {
    return (pixel & 0xffffffu) | (tag << 24);
}

uint pack_color(vec3 rgb, uint tag) {
    return packUnorm4x8(vec4(rgb, 0.0)) | (tag << 24);
}

// The same for bytes, tag 0.
uint pack_bytes(uvec3 rgb) {
    return rgb.r | rgb.g << 8 | rgb.b << 16;
}

// The intensity used by tracking, 0..1.
float luma(vec3 rgb) {
    return dot(rgb, vec3(LUMA_RED, LUMA_GREEN, LUMA_BLUE));
}

#endif
