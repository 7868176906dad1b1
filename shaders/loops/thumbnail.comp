#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/color.glsl"
// A view downsampled by SHRINK for place recognition: the prediction, which shows no people and whose holes the live
// frame has filled; the live frame itself while tracking fails, because then the prediction may show another place.
// Each pixel is the mean of those of its four samples that show something.
// out: thumbnail [n / SHRINK^2] (packed colour, bits of the depth in metres; depth 0 = unknown)
layout(local_size_x = GROUP) in;
layout(constant_id = 0) const uint SHRINK = 1;
readonly buffer ParamsBuffer { Params params; };
readonly buffer Record { TrackingRecord record; };
readonly buffer ModelColor { uint model_color[]; };
readonly buffer ModelDepth { float model_depth[]; };
readonly buffer Color { uint color[]; };
readonly buffer StaticDepth { float static_depth[]; };
writeonly buffer Thumbnails { uvec2 thumbnail[]; };

void main() {
    uint width = params.width / SHRINK, height = params.height / SHRINK;
    uint i = gl_GlobalInvocationID.x;
    if (i >= width * height) return;
    uint v = i / width, u = i - v * width;
    vec3 shade = vec3(0.0);
    float depth = 0.0, count = 0.0;
    for (uint k = 0u; k < 4u; ++k) {
        uvec2 at = uvec2(u, v) * SHRINK + SHRINK / 4u + uvec2(k & 1u, k >> 1) * (SHRINK / 2u);
        uint j = at.y * params.width + at.x;
        bool live = record.failed != 0u;
        float z = live ? static_depth[j] : model_depth[j];
        float known = z > 0.0 ? 1.0 : 0.0;
        shade += known * unpack_color(live ? color[j] : model_color[j]);
        depth += known * z;
        count += known;
    }
    float scale = 1.0 / max(count, 1.0);
    thumbnail[i] = uvec2(pack_color(shade * scale, 0u), floatBitsToUint(depth * scale));
}
