#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/association.glsl"
#include "include/depth_test_read.glsl"
#include "include/geometry.glsl"
#include "include/se3.glsl"
// Samples a grid of live pixels and the model at their projections, after both were aligned.
// in:  live_depth [n], model_depth [n] and cells [n] of the prediction at record.world_model; live and model
//      photometric images (intensity or -1, gradient) at the coarsest level; record.model_live
// out: samples [LOOP_GRID_WIDTH * LOOP_GRID_HEIGHT]
layout(local_size_x = GROUP) in;
layout(constant_id = 0) const uint CELL_STRIDE = 1;
readonly buffer ParamsBuffer { Params params; };
readonly buffer Record { TrackingRecord record; };
readonly buffer LiveDepth { float live_depth[]; };
readonly buffer ModelDepth { float model_depth[]; };
readonly buffer CellIndices { uint cell_indices[]; };
readonly buffer Appearances { uvec4 appearance[]; };
readonly buffer LivePhotometric { vec4 live_photometric[]; };
readonly buffer ModelPhotometric { vec4 model_photometric[]; };
writeonly buffer Samples { LoopSample samples[]; };

const uint COARSEST = LEVELS - 1u;

// The pixel of the coarsest level that covers a pixel of the finest.
uint coarsest_index(Camera coarsest, uvec2 pixel) {
    return (pixel.y >> COARSEST) * coarsest.width + (pixel.x >> COARSEST);
}

void main() {
    Camera c = camera_at(params, 0u);
    uint i = gl_GlobalInvocationID.x;
    const uvec2 grid = uvec2(LOOP_GRID_WIDTH, LOOP_GRID_HEIGHT);
    if (i >= grid.x * grid.y) return;
    uvec2 at = uvec2(i % grid.x, i / grid.x);
    uvec2 pixel = (2u * at + 1u) * uvec2(c.width, c.height) / (2u * grid);  // the middle of a cell of the grid
    float z = live_depth[pixel.y * c.width + pixel.x];
    vec3 p = back_project(c, vec2(pixel), z);
    Camera coarsest = camera_at(params, COARSEST);
    LoopSample result = LoopSample(vec4(p, 0.0), 0u, 0u, -1.0, -1.0);
    result.live_intensity = live_photometric[coarsest_index(coarsest, pixel)].x;
    vec3 q = transform(record.model_live, p);
    if (z > 0.0 && q.z > NEAR_PLANE) {
        ivec2 cell = nearest_pixel(c, project(c, q));
        if (in_image(c, cell)) {
            uint j = index_of(c, cell);
            uint surfel = CELL_INDEX(j);
            float model = model_depth[j];
            if (surfel != EMPTY_CELL && model > 0.0) {
                result.point.w = model;
                result.model_intensity = model_photometric[coarsest_index(coarsest, uvec2(cell))].x;
                result.created = appearance[surfel][CREATED];
                result.valid = abs(model - q.z) < association_gate(params, z) ? 1u : 0u;
            }
        }
    }
    samples[i] = result;
}
