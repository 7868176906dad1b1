// Needs params and the buffer `coarse_geometry` (normal, depth) at half the resolution.
#ifndef POSEFUSION_NORMAL_UPSAMPLING
#define POSEFUSION_NORMAL_UPSAMPLING
#include "noise.glsl"

// Bilinear mean of the coarse normals on the surface of pixel (u, v) at depth z; its length is the share of weight
// found on that surface.
vec3 upsampled_normal(int u, int v, int width, int height, float z, float focal) {
    int coarse_width = width / 2, coarse_height = height / 2;
    float limit = same_surface(params, z) + STEEPEST_SLOPE * z / focal;
    // the pixel lies a quarter of a coarse pixel from its block's centre: weights 3/4 and 1/4 either way
    int u0 = u / 2, v0 = v / 2;
    int u1 = clamp(u0 + ((u & 1) == 0 ? -1 : 1), 0, coarse_width - 1);
    int v1 = clamp(v0 + ((v & 1) == 0 ? -1 : 1), 0, coarse_height - 1);
    ivec4 at = ivec4(v0 * coarse_width + u0, v0 * coarse_width + u1, v1 * coarse_width + u0, v1 * coarse_width + u1);
    vec4 weight = vec4(9.0, 3.0, 3.0, 1.0) / 16.0;
    vec3 n = vec3(0.0);
    for (int k = 0; k < 4; ++k) {
        vec4 g = coarse_geometry[at[k]];
        n += (abs(g.w - z) < limit ? weight[k] : 0.0) * g.xyz;
    }
    return n;
}

#endif
