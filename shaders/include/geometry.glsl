// Pinhole geometry. Camera frame: x right, y down, z forward, metres. Pixel centres at whole numbers at every level.
#ifndef POSEFUSION_GEOMETRY
#define POSEFUSION_GEOMETRY
#include "shared_types.h"

struct Camera {
    float fx, fy, cx, cy;
    uint width, height;
};

// The camera of pyramid level `level`: every output pixel covers a 2^level block and sits at its centre.
Camera camera_at(Params p, uint level) {
    float s = 1.0 / float(1u << level);
    return Camera(p.fx * s, p.fy * s, (p.cx + 0.5) * s - 0.5, (p.cy + 0.5) * s - 0.5, p.width >> level,
                  p.height >> level);
}

vec3 back_project(Camera c, vec2 uv, float z) {
    return vec3((uv.x - c.cx) * z / c.fx, (uv.y - c.cy) * z / c.fy, z);
}

// z must be positive.
vec2 project(Camera c, vec3 p) {
    float inv_z = 1.0 / p.z;
    return vec2(c.fx * p.x * inv_z + c.cx, c.fy * p.y * inv_z + c.cy);
}

// Clamps a projection to at most two pixels outside of the image, so that it fits into an int.
vec2 near_image(Camera c, vec2 uv) {
    return clamp(uv, vec2(-2.0), vec2(c.width, c.height) + 2.0);
}

// The pixel that covers uv; outside of the image if uv is.
ivec2 nearest_pixel(Camera c, vec2 uv) {
    return ivec2(floor(near_image(c, uv) + 0.5));
}

bool in_image(Camera c, ivec2 uv) {
    return uv.x >= 0 && uv.y >= 0 && uv.x < int(c.width) && uv.y < int(c.height);
}

uint index_of(Camera c, ivec2 uv) {
    return uint(uv.y) * c.width + uint(uv.x);
}

#endif
