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
// push: pyramid level
// out: rows with columns COLUMN_SO3_*, row_counts
layout(local_size_x = REDUCTION_GROUP) in;
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
    float s[SO3_COLUMNS];
    for (uint k = 0u; k < SO3_COLUMNS; ++k) s[k] = 0.0;
    uint first = gl_WorkGroupID.x * REDUCTION_PIXELS_PER_GROUP + gl_LocalInvocationID.x;
    for (uint k = 0u; k < REDUCTION_PIXELS; ++k) {
        uint i = min(first + k * REDUCTION_GROUP, n - 1u);
        bool counted = first + k * REDUCTION_GROUP < n;
        uint v = i / c.width;
        vec4 a = live_photometric[i];
        vec3 ray = rotate(record.so3, back_project(c, vec2(i - v * c.width, v), 1.0));
        vec2 uv = project(c, vec3(ray.xy, max(ray.z, NEAR_PLANE)));
        ivec2 cell = nearest_pixel(c, uv);
        bool inside = ray.z > NEAR_PLANE && in_image(c, cell);
        vec4 b = previous_photometric[inside ? index_of(c, cell) : 0u];
        bool use = counted && inside && a.x >= 0.0 && b.x >= 0.0;
        vec2 gradient = 0.5 * (a.yz + b.yz);
        // nearest pixel, extrapolated to the exact position along the gradient
        float r = use ? b.x + dot(b.yz, uv - vec2(cell)) - a.x : 0.0;
        vec3 d = vec3(c.fx * gradient.x, c.fy * gradient.y, 0.0) / ray.z;
        d.z = -(d.x * ray.x + d.y * ray.y) / ray.z;
        vec3 J = use ? cross(ray, d) : vec3(0.0);
        s[0] += J.x * J.x, s[1] += J.x * J.y, s[2] += J.x * J.z;
        s[3] += J.y * J.y, s[4] += J.y * J.z, s[5] += J.z * J.z;
        s[COLUMN_SO3_GRADIENT] += J.x * r;
        s[COLUMN_SO3_GRADIENT + 1u] += J.y * r;
        s[COLUMN_SO3_GRADIENT + 2u] += J.z * r;
        s[COLUMN_SO3_SQUARES] += r * r;
        s[COLUMN_SO3_COUNT] += float(use);
    }
    uint row = REDUCTION_ROW;
    for (uint k = 0u; k < SO3_COLUMNS; ++k) {
        float sum = subgroupAdd(s[k]);
        if (subgroupElect()) rows[row + k] = sum;
    }
    if (subgroupElect()) {
        for (uint k = SO3_COLUMNS; k < REDUCTION_COLUMNS; ++k) rows[row + k] = 0.0;
        if (gl_SubgroupID == 0u) row_counts[gl_WorkGroupID.x] = gl_NumSubgroups;
    }
}
