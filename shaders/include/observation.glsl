// One live pixel as a surfel observation in the world frame. Needs params, record, static_depth, live_geometry, color.
#ifndef POSEFUSION_OBSERVATION
#define POSEFUSION_OBSERVATION
#include "exposure.glsl"
#include "geometry.glsl"
#include "noise.glsl"
#include "se3.glsl"
#include "surfel.glsl"

struct Observation {
    vec3 position;     // world, from the unfiltered depth
    vec3 normal;       // world, from the filtered depth
    vec3 color;        // 0..1, in the exposure of the map
    float radius;      // metres
    float confidence;  // this one observation's share, 0..1
    float weight;      // in the running means
};

Observation observe(Camera c, uint i) {
    uint v = i / c.width;
    vec2 uv = vec2(i - v * c.width, v);
    float z = static_depth[i];
    vec3 normal = live_geometry[i].xyz;
    // lens and depth are most accurate in the middle of the image: Gaussian of the distance from it, in half diagonals
    float diagonal = length(vec2(c.width, c.height)) * max(params.image_over_window, 1.0);
    vec2 d = (uv - vec2(c.cx, c.cy)) / (0.5 * diagonal);
    float centrality = exp(-dot(d, d) / (2.0 * CENTRALITY_SIGMA * CENTRALITY_SIGMA));
    float confidence = record.fusion_weight * centrality;
    float weight = confidence * observation_weight(depth_sigma(params, z), depth_sigma(params, 1.0));
    return Observation(transform(record.world_live, back_project(c, uv, z)), rotate(record.world_live, normal),
                       in_map_exposure(record, color[i]), surfel_radius(z, 0.5 * (c.fx + c.fy), normal.z),
                       confidence, weight);
}

#endif
