#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#include "include/exposure.glsl"
#include "include/geometry.glsl"
#include "include/noise.glsl"
#include "include/reduction.glsl"
#include "include/se3.glsl"
// Colours of live pixels and of the model where they are seen, after tracking: what the exposure of the frame is
// estimated from (exposure_solve). Of each EXPOSURE_BLOCK of pixels one is taken. Not used: what is clipped on one
// side; what is not the same surface. Cauchy weights from the intensities' difference, as in tracking.
// in:  live_depth, depth in model_geometry [n] metres; color, model_color [n]; record.model_live
// out: rows with columns COLUMN_EXPOSURE_*, row_counts
layout(local_size_x = REDUCTION_GROUP) in;
readonly buffer ParamsBuffer { Params params; };
readonly buffer Record { TrackingRecord record; };
readonly buffer LiveDepth { float live_depth[]; };
readonly buffer ModelGeometry { vec4 model_geometry[]; };
readonly buffer Color { uint color[]; };
readonly buffer ModelColor { uint model_color[]; };
writeonly buffer Rows { float rows[]; };
writeonly buffer RowCounts { uint row_counts[]; };

bool unclipped(vec3 rgb) {
    return max(max(rgb.r, rgb.g), rgb.b) < CLIPPED_COLOR;
}

void main() {
    Camera c = camera_at(params, 0u);
    uvec2 blocks = uvec2(c.width, c.height) / EXPOSURE_BLOCK;
    uint n = blocks.x * blocks.y;
    float cut = params.photometric_robust * record.photometric_scale;
    float s[EXPOSURE_COLUMNS];
    for (uint k = 0u; k < EXPOSURE_COLUMNS; ++k) s[k] = 0.0;
    uint first = gl_WorkGroupID.x * REDUCTION_PIXELS_PER_GROUP + gl_LocalInvocationID.x;
    for (uint k = 0u; k < REDUCTION_PIXELS; ++k) {
        uint block = min(first + k * REDUCTION_GROUP, n - 1u);
        bool counted = first + k * REDUCTION_GROUP < n;
        uvec2 at = uvec2(block % blocks.x, block / blocks.x) * EXPOSURE_BLOCK + EXPOSURE_BLOCK / 2u;
        uint i = at.y * c.width + at.x;
        float z = live_depth[i];
        vec3 q = transform(record.model_live, back_project(c, vec2(at), z));
        ivec2 cell = nearest_pixel(c, project(c, vec3(q.xy, max(q.z, NEAR_PLANE))));
        bool inside = counted && z > 0.0 && q.z > NEAR_PLANE && in_image(c, cell);
        uint j = inside ? index_of(c, cell) : 0u;
        float model_depth = model_geometry[j].w;
        bool visible = inside && model_depth > 0.0 && abs(q.z - model_depth) < same_surface(params, q.z);
        vec3 live = unpack_color(color[i]), model = unpack_color(model_color[j]);
        bool use = visible && tag_of(color[i]) == 0u && unclipped(live) && unclipped(model);
        float r = luma(model) - record.photometric_gain * luma(record.exposure.rgb * live);
        float ratio = r / cut;
        float w = use ? 1.0 / (1.0 + ratio * ratio) : 0.0;
        s[COLUMN_EXPOSURE_WEIGHT] += w;
        for (uint channel = 0u; channel < 3u; ++channel) {
            s[COLUMN_EXPOSURE_LIVE + channel] += w * live[channel];
            s[COLUMN_EXPOSURE_MODEL + channel] += w * model[channel];
        }
    }
    uint row = REDUCTION_ROW;
    bool writer = subgroupElect();
    for (uint k = 0u; k < EXPOSURE_COLUMNS; ++k) {
        float sum = subgroupAdd(s[k]);
        if (writer) rows[row + k] = sum;
    }
    if (writer) {
        for (uint k = EXPOSURE_COLUMNS; k < REDUCTION_COLUMNS; ++k) rows[row + k] = 0.0;
        if (gl_SubgroupID == 0u) row_counts[gl_WorkGroupID.x] = gl_NumSubgroups;
    }
}
