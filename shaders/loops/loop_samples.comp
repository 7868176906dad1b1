#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/geometry.glsl"
#include "include/se3.glsl"
#include "include/depth_test_read.glsl"
// A grid of live pixels and what the model shows where they project to, after both were aligned.
// in:  live_depth [n], model_depth [n] and cells [n] of the prediction at record.world_model; live and model photometric
//      images (intensity or -1, gradient) at quarter resolution; record.model_live
// out: samples [GRID_WIDTH * GRID_HEIGHT]
layout(local_size_x = 64) in;
layout(constant_id = 0) const uint CELL_STRIDE = 2;
layout(constant_id = 1) const uint GRID_WIDTH = 32;
layout(constant_id = 2) const uint GRID_HEIGHT = 24;
readonly buffer ParamsBuffer { Params params; };
readonly buffer Record { TrackingRecord record; };
readonly buffer LiveDepth { float live_depth[]; };
readonly buffer ModelDepth { float model_depth[]; };
readonly buffer CellIndices { uint cell_indices[]; };
readonly buffer Appearances { uvec4 appearance[]; };
readonly buffer LivePhotometric { vec4 live_photometric[]; };
readonly buffer ModelPhotometric { vec4 model_photometric[]; };
writeonly buffer Samples { LoopSample samples[]; };

const uint QUARTER = 2u;  // level of the photometric images

void main() {
    Camera c = camera_at(params, 0u);
    uint i = gl_GlobalInvocationID.x;
    if (i >= GRID_WIDTH * GRID_HEIGHT) return;
    uint row = i / GRID_WIDTH, column = i - row * GRID_WIDTH;
    uvec2 pixel = uvec2((2u * column + 1u) * c.width / (2u * GRID_WIDTH), (2u * row + 1u) * c.height / (2u * GRID_HEIGHT));
    float z = live_depth[pixel.y * c.width + pixel.x];
    vec3 p = back_project(c, vec2(pixel), z);
    uint quarter_width = camera_at(params, QUARTER).width;
    LoopSample result = LoopSample(vec4(p, 0.0), 0u, 0u, -1.0, -1.0);
    result.live_intensity = live_photometric[(pixel.y >> QUARTER) * quarter_width + (pixel.x >> QUARTER)].x;
    vec3 q = transform(record.model_live, p);
    if (z > 0.0 && q.z > 0.1) {
        ivec2 cell = ivec2(floor(clamp(project(c, q), vec2(-2.0), vec2(c.width, c.height) + 2.0) + 0.5));
        if (in_image(c, cell)) {
            uint j = uint(cell.y) * c.width + uint(cell.x);
            uint surfel = CELL_INDEX(j);
            float model = model_depth[j];
            if (surfel != EMPTY_CELL && model > 0.0) {
                result.point.w = model;
                result.model_intensity = model_photometric[(uint(cell.y) >> QUARTER) * quarter_width + (uint(cell.x) >> QUARTER)].x;
                result.created = appearance[surfel].z;
                float gate = max(params.association_depth, params.association_sigmas * depth_sigma(params, z));
                result.valid = abs(model - q.z) < gate ? 1u : 0u;
            }
        }
    }
    samples[i] = result;
}
