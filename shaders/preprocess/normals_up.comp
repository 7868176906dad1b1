#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/noise.glsl"
// Geometry at full resolution: the pixel's own depth with the bilinear mean of the half-resolution normals on its
// surface.
// in:  depth [n] metres, coarse_geometry [n / 4]
// out: geometry [n] (normal or 0, depth)
layout(local_size_x = GROUP) in;
readonly buffer ParamsBuffer { Params params; };
readonly buffer Depth { float depth[]; };
readonly buffer CoarseGeometry { vec4 coarse_geometry[]; };
writeonly buffer Geometry { vec4 geometry[]; };
#include "include/normal_upsampling.glsl"

void main() {
    int width = int(params.width), height = int(params.height);
    int i = int(gl_GlobalInvocationID.x);
    if (i >= width * height) return;
    int v = i / width, u = i - v * width;
    float z = depth[i];
    vec3 n = upsampled_normal(u, v, width, height, z, params.fx);
    geometry[i] = vec4(z > 0.0 ? direction_of(n) : vec3(0.0), z);
}
