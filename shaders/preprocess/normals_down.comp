#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/noise.glsl"
// Geometry one level coarser: depth from the depth pyramid, normal = mean of the block's normals on that surface.
// push: level of the input
// in:  geometry [n] at `level`, half_depth at `level` + 1
// out: half_geometry at `level` + 1 (normal or 0, depth)
layout(local_size_x = GROUP) in;
layout(push_constant) uniform Push { uint level; };
readonly buffer ParamsBuffer { Params params; };
readonly buffer Geometry { vec4 geometry[]; };
readonly buffer HalfDepth { float half_depth[]; };
writeonly buffer HalfGeometry { vec4 half_geometry[]; };

void main() {
    int width = int(params.width >> level);
    int half_width = width / 2, half_height = int(params.height >> level) / 2;
    int i = int(gl_GlobalInvocationID.x);
    if (i >= half_width * half_height) return;
    int v = i / half_width, u = i - v * half_width;
    int corner = 2 * v * width + 2 * u;
    float z = half_depth[i];
    float limit = same_surface(params, z);
    vec3 n = vec3(0.0);
    for (int k = 0; k < 4; ++k) {
        vec4 g = geometry[corner + (k & 1) + (k >> 1) * width];
        n += abs(g.w - z) < limit ? g.xyz : vec3(0.0);
    }
    half_geometry[i] = vec4(z > 0.0 ? direction_of(n) : vec3(0.0), z);
}
