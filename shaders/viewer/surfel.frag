#version 460
// The disc of a surfel, lit from the eye. Weak perspective: within one disc all rays are taken to be parallel.
layout(location = 0) flat in vec3 in_color;
layout(location = 1) flat in vec3 in_normal;
layout(location = 2) flat in float in_size;
layout(location = 0) out vec4 color;

const float MIN_DISC = 3.0;      // pixels; smaller ones stay squares, as cut ones would leave holes
const float MIN_SLANT = 0.2;     // cosine; discs seen from the side keep this width
const float AMBIENT = 0.45;

void main() {
    float facing = max(-in_normal.z, MIN_SLANT);
    vec2 d = 2.0 * gl_PointCoord - 1.0;
    float dz = dot(in_normal.xy, d) / facing;
    if (in_size > MIN_DISC && dot(d, d) + dz * dz > 1.0) discard;
    color = vec4(in_color * mix(AMBIENT, 1.0, facing), 1.0);
}
