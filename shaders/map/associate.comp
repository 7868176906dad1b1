#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/association.glsl"
#include "include/depth_test_read.glsl"
#include "include/geometry.glsl"
#include "include/se3.glsl"
// Which surfel does each live pixel observe? Of the index map's cells within one pixel, the one nearest to the pixel's
// ray whose depth agrees; its normal must agree, too. Several pixels may find the same surfel: the nearest owns it
// (ties: the lower pixel index), so the result does not depend on the order of execution.
// in:  static_depth [n], live_geometry [n] (normal, filtered depth), cells, surfel normals
// out: association [n]: surfel index, NEW_SURFEL or NO_SURFEL; owner [count] = least key of its pixels
layout(local_size_x = GROUP) in;
layout(constant_id = 0) const uint CELL_STRIDE = 1;
layout(constant_id = 1) const int INDEX_SCALE = 1;
readonly buffer ParamsBuffer { Params params; };
readonly buffer Record { TrackingRecord record; };
readonly buffer StaticDepth { float static_depth[]; };
readonly buffer LiveGeometry { vec4 live_geometry[]; };
readonly buffer CellKeys { uint cell_keys[]; };
readonly buffer CellIndices { uint cell_indices[]; };
readonly buffer Normals { vec4 normal_radius[]; };
writeonly buffer Association { uint association[]; };
buffer Owner { uint owner[]; };

void main() {
    Camera c = camera_at(params, 0u);
    uint i = gl_GlobalInvocationID.x;
    if (i >= c.width * c.height) return;
    int v = int(i / c.width), u = int(i) - v * int(c.width);
    float z = static_depth[i];
    vec4 live = live_geometry[i];
    bool has_normal = live.xyz != vec3(0.0);
    if (record.failed != 0u || z <= 0.0 || !has_normal) {
        association[i] = NO_SURFEL;
        return;
    }
    float ray_length = length(back_project(c, vec2(u, v), 1.0));
    float gate = association_gate(params, z) / ray_length;

    ivec2 size = ivec2(c.width, c.height) * INDEX_SCALE;
    ivec2 centre2 = ivec2(2 * u + 1, 2 * v + 1) * INDEX_SCALE;  // twice the pixel centre, in cells
    float best_distance = UNBOUNDED;
    uint best_cell = EMPTY_CELL;
    // cells have no middle where the scale is even, one where it is odd
    const int last = INDEX_SCALE - 1 + (INDEX_SCALE & 1);
    for (int dv = -INDEX_SCALE; dv <= last; ++dv) {
        int row = (centre2.y >> 1) + dv;
        for (int du = -INDEX_SCALE; du <= last; ++du) {
            int column = (centre2.x >> 1) + du;
            bool inside = row >= 0 && column >= 0 && row < size.y && column < size.x;
            uint cell = inside ? uint(row * size.x + column) : 0u;
            uint bits = CELL_KEY(cell);
            bool hit = inside && bits != EMPTY_CELL && abs(uintBitsToFloat(bits) - z) < gate;
            vec2 offset = vec2(2 * column + 1 - centre2.x, 2 * row + 1 - centre2.y);
            float distance = dot(offset, offset);
            if (hit && distance < best_distance) {
                best_distance = distance;
                best_cell = cell;
            }
        }
    }
    if (best_cell == EMPTY_CELL) {
        association[i] = NEW_SURFEL;
        return;
    }
    uint surfel = CELL_INDEX(best_cell);
    vec3 normal = rotate(inverse_pose(record.world_live), normal_radius[surfel].xyz);
    if (abs(normal.z) < MIN_JUDGED_COSINE || dot(normal, live.xyz) > params.association_cosine) {
        association[i] = surfel;
        atomicMin(owner[surfel], owner_key(uint(best_distance), i));
    } else {
        association[i] = NEW_SURFEL;
    }
}
