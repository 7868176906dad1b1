#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/association.glsl"
#include "include/geometry.glsl"
#include "include/surfel.glsl"
// Fuses each pixel that owns a surfel into it: weighted running means of position, normal, colour and radius. An
// observation much coarser than the surfel (seen from farther away) only confirms it.
layout(local_size_x = GROUP) in;
readonly buffer ParamsBuffer { Params params; };
readonly buffer Record { TrackingRecord record; };
readonly buffer StaticDepth { float static_depth[]; };
readonly buffer LiveGeometry { vec4 live_geometry[]; };
readonly buffer Color { uint color[]; };
readonly buffer Association { uint association[]; };
readonly buffer Owner { uint owner[]; };
buffer Positions { vec4 position_confidence[]; };
buffer Normals { vec4 normal_radius[]; };
buffer Appearances { uvec4 appearance[]; };
#include "include/observation.glsl"

void main() {
    Camera c = camera_at(params, 0u);
    uint i = gl_GlobalInvocationID.x;
    if (i >= c.width * c.height) return;
    uint s = association[i];
    if (s >= NEW_SURFEL || owner_pixel(owner[s]) != i) return;
    Observation o = observe(c, i);
    vec4 position = position_confidence[s];
    vec4 normal = normal_radius[s];
    uvec4 look = appearance[s];
    vec3 shade = surfel_color(look);
    float weight = surfel_weight(look);
    if (o.radius < MUCH_COARSER * normal.w) {
        float t = o.weight / (weight + o.weight);
        position.xyz = mix(position.xyz, o.position, t);
        normal = vec4(normalize(mix(normal.xyz, o.normal, t)), mix(normal.w, o.radius, t));
        shade = mix(shade, o.color, t);
        weight = min(weight + o.weight, params.max_weight);
    }
    position.w += o.confidence;
    position_confidence[s] = position;
    normal_radius[s] = normal;
    appearance[s] = pack_appearance(shade, weight, look[CREATED], params.frame);
}
