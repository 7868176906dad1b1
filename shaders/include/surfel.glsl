// A surfel in three streams of 16 bytes (so that each stays within the smallest storage buffer range for 8 M surfels):
//   position_confidence  vec4: world position (m), confidence; confidence 0 = dead slot
//   normal_radius        vec4: world unit normal, radius (m)
//   appearance           uvec4: red | green << 16, blue | half(weight) << 16 (colours unorm16);
//                        frames: [CREATED], [LAST_SEEN]
#ifndef POSEFUSION_SURFEL
#define POSEFUSION_SURFEL
#include "shared_constants.h"

const float UNORM16_MAX = 65535.0;

vec3 surfel_color(uvec4 appearance) {
    return vec3(unpackUnorm2x16(appearance.x), float(appearance.y & 0xffffu) / UNORM16_MAX);
}

// Weight of the running means, in observations at 1 m.
float surfel_weight(uvec4 appearance) {
    return unpackHalf2x16(appearance.y >> 16).x;
}

uvec4 pack_appearance(vec3 color, float weight, uint created, uint last_seen) {
    uint blue = packUnorm2x16(vec2(color.b, 0.0)) & 0xffffu;
    return uvec4(packUnorm2x16(color.rg), blue | (packHalf2x16(vec2(weight, 0.0)) << 16), created, last_seen);
}

// Covers the pixel's diagonal; slanted surfels grow with the slant.
float surfel_radius(float z, float focal, float normal_z) {
    float r = PIXEL_DIAGONAL * z / focal;
    return min(MAX_SLANT_GROWTH * r, r / max(abs(normal_z), MIN_SLANT_COSINE));
}

// Precision of one depth measurement relative to one at 1 m: the weight of an observation in the running means.
float observation_weight(float sigma, float sigma_1m) {
    return sigma_1m * sigma_1m / (sigma * sigma);
}

#endif
