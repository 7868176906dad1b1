#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/geometry.glsl"
#include "include/surfel.glsl"
#include "include/when.glsl"
// Writes the new surfels after the existing ones, in the order of the pixels. `grow` adds them to counters.count
// afterwards.
layout(local_size_x = GROUP) in;
readonly buffer ParamsBuffer { Params params; };
readonly buffer Record { TrackingRecord record; };
readonly buffer StaticDepth { float static_depth[]; };
readonly buffer LiveGeometry { vec4 live_geometry[]; };
readonly buffer Color { uint color[]; };
readonly buffer Association { uint association[]; };
readonly buffer ChunkOffsets { uint chunk_offsets[]; };
readonly buffer Counters { MapRecord counters; };
writeonly buffer Positions { vec4 position_confidence[]; };
writeonly buffer Normals { vec4 normal_radius[]; };
writeonly buffer Appearances { uvec4 appearance[]; };
#include "include/observation.glsl"

void main() {
    Camera c = camera_at(params, 0u);
    uint n = c.width * c.height;
    uint chunk = gl_GlobalInvocationID.x;
    if (chunk * CHUNK >= n) return;
    uint slot = counters.count + chunk_offsets[chunk];
    for (uint k = 0u; k < CHUNK; ++k) {
        uint i = chunk * CHUNK + k;
        WHEN(i < n && association[min(i, n - 1u)] == NEW_SURFEL) {
            Observation o = observe(c, i);
            position_confidence[slot] = vec4(o.position, max(o.confidence, MIN_NEW_CONFIDENCE));
            normal_radius[slot] = vec4(o.normal, o.radius);
            appearance[slot] =
                pack_appearance(o.color, max(o.weight, MIN_NEW_CONFIDENCE), params.frame, params.frame);
            ++slot;
        }
    }
}
