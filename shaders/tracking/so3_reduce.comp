#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#include "include/shared_types.h"
#include "include/geometry.glsl"
#include "include/se3.glsl"
#include "include/reduction.glsl"
// Rotation-only pre-alignment of the live image to the PREVIOUS live image, both at quarter resolution: normal
// equations of the photometric error under the homography K R K^-1.
// in:  live_photometric, previous_photometric [n] (intensity or -1, gradient), record.so3
// out: rows: 0-5 upper triangle of the 3x3 system, 6-8 right-hand side, 9 sum of squares, 10 count
layout(local_size_x = 64) in;
layout(push_constant) uniform Push { uint level; };
readonly buffer ParamsBuffer { Params params; };
readonly buffer LivePhotometric { vec4 live_photometric[]; };
readonly buffer PreviousPhotometric { vec4 previous_photometric[]; };
readonly buffer Record { TrackingRecord record; };
writeonly buffer Rows { float rows[]; };
writeonly buffer RowCounts { uint row_counts[]; };

void main() {
    Camera c = camera_at(params, level);
    uint n = c.width * c.height;
    float s[11];
    for (int k = 0; k < 11; ++k) s[k] = 0.0;
    uint first = gl_WorkGroupID.x * REDUCTION_GROUP * REDUCTION_PIXELS + gl_LocalInvocationID.x;
    for (uint k = 0u; k < REDUCTION_PIXELS; ++k) {
        uint i = min(first + k * REDUCTION_GROUP, n - 1u);
        bool counted = first + k * REDUCTION_GROUP < n;
        uint v = i / c.width;
        vec4 a = live_photometric[i];
        vec3 ray = rotate(record.so3, back_project(c, vec2(i - v * c.width, v), 1.0));
        vec2 uv = project(c, vec3(ray.xy, max(ray.z, 0.1)));
        ivec2 cell = ivec2(floor(uv + 0.5));
        bool inside = ray.z > 0.1 && in_image(c, cell);
        vec4 b = previous_photometric[inside ? uint(cell.y) * c.width + uint(cell.x) : 0u];
        bool use = counted && inside && a.x >= 0.0 && b.x >= 0.0;
        vec2 gradient = 0.5 * (a.yz + b.yz);
        // nearest pixel, moved to the exact place along the gradient
        float r = use ? b.x + dot(b.yz, uv - vec2(cell)) - a.x : 0.0;
        vec3 d = vec3(c.fx * gradient.x, c.fy * gradient.y, 0.0) / ray.z;
        d.z = -(d.x * ray.x + d.y * ray.y) / ray.z;
        vec3 J = use ? cross(ray, d) : vec3(0.0);
        s[0] += J.x * J.x; s[1] += J.x * J.y; s[2] += J.x * J.z;
        s[3] += J.y * J.y; s[4] += J.y * J.z; s[5] += J.z * J.z;
        s[6] += J.x * r; s[7] += J.y * r; s[8] += J.z * r;
        s[9] += r * r;
        s[10] += float(use);
    }
    uint row = (gl_WorkGroupID.x * REDUCTION_MAX_ROWS + gl_SubgroupID) * REDUCTION_COLUMNS;
    for (int k = 0; k < 11; ++k) {
        float sum = subgroupAdd(s[k]);
        if (subgroupElect()) rows[row + uint(k)] = sum;
    }
    if (subgroupElect()) {
        for (uint k = 11u; k < REDUCTION_COLUMNS; ++k) rows[row + k] = 0.0;
        if (gl_SubgroupID == 0u) row_counts[gl_WorkGroupID.x] = gl_NumSubgroups;
    }
}
