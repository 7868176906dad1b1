// The noise of a depth measurement (engine/core/depth_noise.hpp).
#ifndef POSEFUSION_NOISE
#define POSEFUSION_NOISE
#include "shared_types.h"

// Standard deviation of one measurement, metres.
float depth_sigma(Params p, float z) {
    float d = z - p.noise_c;
    return p.noise_a + p.noise_b * d * d;
}
vec4 depth_sigma(Params p, vec4 z) {
    vec4 d = z - p.noise_c;
    return p.noise_a + p.noise_b * d * d;
}

// Depths that differ from z by less than this are measurements of the same surface, metres.
float same_surface(Params p, float z) {
    return SAME_SURFACE_SIGMAS * depth_sigma(p, z);
}

// The direction of a mean of unit normals; 0 if there is none.
vec3 direction_of(vec3 n) {
    float length2 = dot(n, n);
    return length2 > MIN_NORMAL_LENGTH2 ? n * inversesqrt(length2) : vec3(0.0);
}

#endif
