// Which surfel a pixel observes, and which of the pixels that observe a surfel owns it.
#ifndef POSEFUSION_ASSOCIATION
#define POSEFUSION_ASSOCIATION
#include "noise.glsl"

// A measurement at depth z and a surfel are of the same surface if their depths differ by less than this, metres.
float association_gate(Params p, float z) {
    return max(p.association_depth, p.association_sigmas * depth_sigma(p, z));
}

// Pixels compete for a surfel by the smallest key: squared distance in half cells first, then the pixel.
uint owner_key(uint distance2, uint pixel) {
    const uint farthest = (1u << (32u - OWNER_PIXEL_BITS)) - 1u;
    return (min(distance2, farthest) << OWNER_PIXEL_BITS) | pixel;
}

uint owner_pixel(uint key) {
    return key & (MAX_PIXELS - 1u);
}

#endif
