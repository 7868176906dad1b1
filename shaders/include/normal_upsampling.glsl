// Needs params and `coarse_geometry` (normal, depth) at half the resolution.
#ifndef POSEFUSION_NORMAL_UPSAMPLING
#define POSEFUSION_NORMAL_UPSAMPLING

// Bilinear mean of the coarse normals on the surface of pixel (u, v) at depth z; its length tells how much was found.
vec3 upsampled_normal(int u, int v, int width, int height, float z, float focal) {
    int coarse_width = width / 2, coarse_height = height / 2;
    float limit = 3.0 * depth_sigma(params, z) + 4.0 * z / focal;
    // the pixel lies a quarter of a coarse pixel from its block's centre
    int u0 = u / 2, v0 = v / 2;
    int u1 = clamp(u0 + ((u & 1) == 0 ? -1 : 1), 0, coarse_width - 1);
    int v1 = clamp(v0 + ((v & 1) == 0 ? -1 : 1), 0, coarse_height - 1);
    ivec4 at = ivec4(v0 * coarse_width + u0, v0 * coarse_width + u1, v1 * coarse_width + u0, v1 * coarse_width + u1);
    vec4 weight = vec4(0.5625, 0.1875, 0.1875, 0.0625);
    vec3 n = vec3(0.0);
    for (int k = 0; k < 4; ++k) {
        vec4 g = coarse_geometry[at[k]];
        n += (abs(g.w - z) < limit ? weight[k] : 0.0) * g.xyz;
    }
    return n;
}

#endif
