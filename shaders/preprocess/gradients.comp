#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
// Intensity and its central differences. Unknown (-1) where the pixel or one of its four neighbours is.
// push: pyramid level
// in:  intensity   [n] or -1
// out: photometric [n] (intensity or -1, d intensity / du, d intensity / dv, 0), derivatives per pixel of this level
layout(local_size_x = GROUP) in;
layout(push_constant) uniform Push { uint level; };
readonly buffer ParamsBuffer { Params params; };
readonly buffer Intensity { float intensity[]; };
writeonly buffer Photometric { vec4 photometric[]; };

void main() {
    int width = int(params.width >> level), height = int(params.height >> level);
    int i = int(gl_GlobalInvocationID.x);
    if (i >= width * height) return;
    int v = i / width, u = i - v * width;
    float here = intensity[i];
    float left = intensity[v * width + max(u - 1, 0)], right = intensity[v * width + min(u + 1, width - 1)];
    float up = intensity[max(v - 1, 0) * width + u], down = intensity[min(v + 1, height - 1) * width + u];
    bool inner = u > 0 && v > 0 && u + 1 < width && v + 1 < height;
    bool known = inner && min(min(min(left, right), min(up, down)), here) >= 0.0;
    photometric[i] = vec4(known ? here : -1.0, 0.5 * (right - left), 0.5 * (down - up), 0.0);
}
