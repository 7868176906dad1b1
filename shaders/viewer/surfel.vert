#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/surfel.glsl"
#include "include/colormap.glsl"
#include "include/viewer_view.glsl"
// One surfel is one point, as large as its disc is wide; surfel.frag cuts the disc out of it.
// in:  surfel streams of a snapshot, one vertex per slot or, with a stride, per so many slots
// out: point; colour, normal in the viewing camera, whether the disc is large enough to be cut out
readonly buffer Positions { vec4 position_confidence[]; };
readonly buffer Normals { vec4 normal_radius[]; };
readonly buffer Appearances { uvec4 appearance[]; };
layout(location = 0) flat out vec3 out_color;
layout(location = 1) flat out vec3 out_normal;
layout(location = 2) flat out float out_size;

const float MAX_SIZE = 64.0;      // pixels; nearer discs are cut off, their neighbours cover the rest
const vec4 NOWHERE = vec4(2.0, 2.0, 2.0, 1.0);

vec3 look(uvec4 a, vec3 normal, float confidence) {
    switch (view.color_mode) {
        case COLOR_NORMAL: return 0.5 + 0.5 * normal;
        case COLOR_CONFIDENCE: return viridis(confidence / (2.0 * view.stable_confidence));
        case COLOR_AGE: return viridis(1.0 - (view.now - float(a[LAST_SEEN])) / view.age_scale);
        case COLOR_TIME: return viridis(float(a[CREATED]) / max(view.now, 1.0));
        default: return surfel_color(a);
    }
}

void main() {
    uint i = uint(gl_VertexIndex) * view.stride;
    vec4 surfel = position_confidence[i];
    gl_Position = NOWHERE;
    gl_PointSize = 1.0;
    out_color = vec3(0.0);
    out_normal = vec3(0.0, 0.0, -1.0);
    out_size = 1.0;
    if (surfel.w <= 0.0 || surfel.w < view.min_confidence) return;
    vec3 p = to_camera(surfel.xyz);
    if (p.z < view.near) return;
    vec4 shape = normal_radius[i];
    vec3 normal = turn(shape.xyz);
    if (dot(normal, p) >= 0.0) return;  // seen from behind
    gl_Position = to_clip(p);
    float radius = shape.w * sqrt(float(view.stride));  // the same area is covered
    out_size = clamp(2.0 * radius * view.focal.y / p.z, 1.0, MAX_SIZE);
    gl_PointSize = out_size;
    out_color = look(appearance[i], shape.xyz, surfel.w);
    out_normal = normal;
}
