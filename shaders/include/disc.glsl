// The disc of a surfel, as the prediction draws it. Needs params.
#ifndef POSEFUSION_DISC
#define POSEFUSION_DISC
#include "geometry.glsl"
#include "noise.glsl"

// Where the ray of pixel uv meets a surfel's disc (camera frame): (depth, squared distance from the centre in radii);
// (0, 0) if it misses it.
vec2 disc_hit(Camera c, vec2 uv, vec3 centre, vec3 normal, float radius) {
    vec3 ray = back_project(c, uv, 1.0);
    float slope = dot(normal, ray);
    float z = slope < -MIN_DISC_SLOPE ? dot(normal, centre) / slope : 0.0;
    vec3 offset = z * ray - centre;
    float distance2 = dot(offset, offset) / (radius * radius);
    return distance2 <= 1.0 && z > NEAR_PLANE ? vec2(z, distance2) : vec2(0.0);
}

// Which disc a pixel shows: the nearest surface, and of its discs the one whose centre is closest to the ray. For that,
// depth counts as farther towards the rim, by up to DISC_DEPTH_SIGMAS standard deviations of the sensor. Taking the
// nearest depth alone would bias the model towards the camera by the noise of its surfels; sorting by depth layers
// first would show, wherever a slanted surface crosses from one layer to the next, the neighbouring disc and its
// colour, always from the nearer side.
uint disc_key(vec2 hit) {
    return floatBitsToUint(hit.x + DISC_DEPTH_SIGMAS * depth_sigma(params, hit.x) * hit.y);
}

#endif
