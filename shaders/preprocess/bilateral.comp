#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/noise.glsl"
// Bilateral filter of the static depth. The range kernel is measured in standard deviations of the depth noise at that
// depth, so that near detail is kept and far noise is smoothed. Both kernels are polynomials close to a Gaussian that
// need no exp: see BILATERAL_SPREAD.
// in:  static_depth   [n] metres, 0 = none
// out: filtered_depth [n] metres, 0 = none
layout(local_size_x = 16, local_size_y = 4) in;  // 64 x 4 pixels, whose windows overlap
layout(constant_id = 0) const int RADIUS = 1;
readonly buffer ParamsBuffer { Params params; };
readonly buffer StaticDepth { float static_depth[]; };
writeonly buffer FilteredDepth { float filtered_depth[]; };

const float MIN_WEIGHT = 1e-12;  // no division by 0 at pixels without depth; others have their own weight of 1

void main() {
    int width = int(params.width), height = int(params.height);
    int u0 = int(gl_GlobalInvocationID.x * PIXELS_PER_INVOCATION);
    int v = int(gl_GlobalInvocationID.y);
    if (u0 >= width || v >= height) return;

    // Four neighbouring pixels at a time: their windows share nearly all loads.
    int base = v * width + u0;
    vec4 centre = vec4(static_depth[base], static_depth[base + 1], static_depth[base + 2], static_depth[base + 3]);
    vec4 sigma = depth_sigma(params, centre);
    vec4 range = params.bilateral_range / (sigma * sigma) / BILATERAL_SPREAD;
    vec4 sum = vec4(0.0), weights = vec4(0.0);
    for (int dv = -RADIUS; dv <= RADIUS; ++dv) {
        int row = clamp(v + dv, 0, height - 1) * width;
        for (int s = -RADIUS; s < RADIUS + int(PIXELS_PER_INVOCATION); ++s) {
            float z = static_depth[row + clamp(u0 + s, 0, width - 1)];
            vec4 du = vec4(s) - vec4(0, 1, 2, 3);
            vec4 d = vec4(z) - centre;
            vec4 space = max(1.0 - (du * du + float(dv * dv)) * params.bilateral_space / BILATERAL_SPREAD, 0.0);
            vec4 value = max(1.0 - d * d * range, 0.0);
            vec4 inside = vec4(lessThanEqual(abs(du), vec4(float(RADIUS))));
            vec4 w = space * space * value * value * inside * float(z > 0.0);
            sum += w * z;
            weights += w;
        }
    }
    vec4 result = sum / max(weights, vec4(MIN_WEIGHT));
    for (int k = 0; k < int(PIXELS_PER_INVOCATION); ++k)
        filtered_depth[base + k] = centre[k] > 0.0 ? result[k] : 0.0;
}
