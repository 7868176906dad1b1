#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/noise.glsl"
// One pyramid step. Depth: mean of the 2x2 block's samples that belong to its nearest surface, never a mixture of
// foreground and background. Intensity: 4x4 binomial (1 3 3 1), centred on the block; -1 (unknown) if one of the inner
// four is.
// push: level of the input
// in:  depth, intensity               at `level`
// out: half_depth, half_intensity     at `level` + 1
layout(local_size_x = GROUP) in;
layout(push_constant) uniform Push { uint level; };
readonly buffer ParamsBuffer { Params params; };
readonly buffer Depth { float depth[]; };
readonly buffer Intensity { float intensity[]; };
writeonly buffer HalfDepth { float half_depth[]; };
writeonly buffer HalfIntensity { float half_intensity[]; };

const float INNER_WEIGHT = 3.0;  // of the binomial, whose outer samples have 1

void main() {
    int width = int(params.width >> level), height = int(params.height >> level);
    int half_width = width / 2, half_height = height / 2;
    int i = int(gl_GlobalInvocationID.x);
    if (i >= half_width * half_height) return;
    int v = i / half_width, u = i - v * half_width;

    int corner = 2 * v * width + 2 * u;
    vec4 z = vec4(depth[corner], depth[corner + 1], depth[corner + width], depth[corner + width + 1]);
    bvec4 is_known = greaterThan(z, vec4(0.0));
    vec4 known = vec4(is_known);
    vec4 masked = mix(vec4(UNBOUNDED), z, is_known);  // by bools: a weighted mean may round z away
    float nearest = min(min(masked.x, masked.y), min(masked.z, masked.w));
    vec4 same = known * vec4(lessThanEqual(z, vec4(nearest + same_surface(params, nearest))));
    float count = dot(same, vec4(1.0));
    half_depth[i] = count > 0.0 ? dot(same, z) / count : 0.0;

    float sum = 0.0, weights = 0.0;
    bool unknown = false;
    for (int dv = -1; dv <= 2; ++dv) {
        int row = clamp(2 * v + dv, 0, height - 1) * width;
        for (int du = -1; du <= 2; ++du) {
            float value = intensity[row + clamp(2 * u + du, 0, width - 1)];
            bool inner = du >= 0 && du <= 1 && dv >= 0 && dv <= 1;
            unknown = unknown || (inner && value < 0.0);
            float w = (du >= 0 && du <= 1 ? INNER_WEIGHT : 1.0) * (dv >= 0 && dv <= 1 ? INNER_WEIGHT : 1.0) *
                      float(value >= 0.0);
            sum += w * value;
            weights += w;
        }
    }
    half_intensity[i] = unknown ? -1.0 : sum / weights;
}
