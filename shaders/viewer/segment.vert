#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/color.glsl"
#include "include/viewer_view.glsl"
// A line of some width: two triangles per segment. A segment without length becomes a square.
// in:  segments, six vertices each
readonly buffer Segments { Segment segments[]; };
layout(location = 0) flat out vec3 out_color;

const vec2 CORNERS[6] = vec2[](vec2(0, -1), vec2(1, -1), vec2(1, 1), vec2(0, -1), vec2(1, 1), vec2(0, 1));
const float NEARER = 1.01;       // lines on a surface are drawn in front of it
const float MIN_LENGTH2 = 1e-6;  // pixels^2; shorter ones have no direction

void main() {
    Segment s = segments[gl_VertexIndex / 6];
    vec2 corner = CORNERS[gl_VertexIndex % 6];
    out_color = unpack_color(s.color);
    vec3 a = to_camera(s.from), b = to_camera(s.to);
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    if (max(a.z, b.z) < view.near) return;
    if (a.z < view.near) a = mix(b, a, (b.z - view.near) / (b.z - a.z));
    if (b.z < view.near) b = mix(a, b, (a.z - view.near) / (a.z - b.z));
    vec4 clip_a = to_clip(a), clip_b = to_clip(b);
    vec2 along = (clip_b.xy / clip_b.w - clip_a.xy / clip_a.w) * view.size;
    along = dot(along, along) > MIN_LENGTH2 ? normalize(along) : vec2(1.0, 0.0);
    vec2 across = vec2(-along.y, along.x);
    vec4 clip = corner.x == 0.0 ? clip_a : clip_b;
    vec2 offset = (corner.y * across + (2.0 * corner.x - 1.0) * along) * s.width / view.size;  // half a width each way
    gl_Position = vec4(clip.xy + offset * clip.w, min(clip.z * NEARER, clip.w), clip.w);
}
