#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/color.glsl"
// Undistorts an image: every pixel looks up where the distorted image shows its ray. Colour is
// interpolated, with positions in whole 1/32 pixels and weights in whole 1/1024, so that every device gives the same
// bytes; outside it repeats the border, which creates no gradient. Depth is that of the nearest pixel, since a mean of
// two surfaces lies on neither; outside it is 0.
// push: size of both images, pixels
// in:  lens [n] (u, v) pixels, distorted_color [n], distorted_depth [n]
// out: color [n], depth [n]
layout(local_size_x = 256) in;
layout(push_constant) uniform Push { int width, height; };
readonly buffer Lens { vec2 lens[]; };
readonly buffer DistortedColor { uint distorted_color[]; };
readonly buffer DistortedDepth { float distorted_depth[]; };
writeonly buffer Color { uint color[]; };
writeonly buffer Depth { float depth[]; };

const int FRACTION_BITS = 5;  // as in OpenCV's remap()
const int FRACTIONS = 1 << FRACTION_BITS;
const uint RED_BLUE = 0xff00ffu;  // their bits of a packed colour

// Between two neighbours of a row, with weights of sum FRACTIONS. A channel needs 13 bits: red and blue share a word.
uvec3 between(uint a, uint b, uint weight_a, uint weight_b) {
    uint red_blue = weight_a * (a & RED_BLUE) + weight_b * (b & RED_BLUE);
    uint green = weight_a * (a >> 8 & 255u) + weight_b * (b >> 8 & 255u);
    return uvec3(red_blue & 0xffffu, green, red_blue >> 16);
}

// Rounds to the nearest integer, ties to even. The parts are exact in floats of this size, whereas
// roundEven() is not exact everywhere: a software driver without an instruction for its vector width adds a half and
// cuts.
ivec2 nearest_whole(vec2 value) {
    vec2 below = floor(value);
    vec2 rest = value - below;
    ivec2 whole = ivec2(below);
    bvec2 up = greaterThan(rest, vec2(0.5));
    bvec2 tie = equal(rest, vec2(0.5));
    bvec2 odd = notEqual(whole & 1, ivec2(0));
    return whole + ivec2(up.x || (tie.x && odd.x), up.y || (tie.y && odd.y));
}

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= uint(width * height)) return;
    ivec2 last = ivec2(width, height) - 1;
    vec2 p = clamp(lens[i], vec2(-2.0), vec2(last) + 2.0);  // two pixels outside are equivalent to far outside

    ivec2 fine = nearest_whole(p * float(FRACTIONS));
    ivec2 corner = fine >> FRACTION_BITS;
    uvec2 far_weight = uvec2(fine & (FRACTIONS - 1)), near_weight = uint(FRACTIONS) - far_weight;
    ivec2 near = clamp(corner, ivec2(0), last), far = clamp(corner + 1, ivec2(0), last);
    int near_row = near.y * width, far_row = far.y * width;
    uvec3 above =
        between(distorted_color[near_row + near.x], distorted_color[near_row + far.x], near_weight.x, far_weight.x);
    uvec3 below =
        between(distorted_color[far_row + near.x], distorted_color[far_row + far.x], near_weight.x, far_weight.x);
    uvec3 sum = near_weight.y * above + far_weight.y * below;
    uvec3 mean = (sum + uint(FRACTIONS * FRACTIONS / 2)) >> (2 * FRACTION_BITS);
    color[i] = pack_bytes(mean);

    ivec2 nearest = nearest_whole(p);
    bool inside = all(greaterThanEqual(nearest, ivec2(0))) && all(lessThanEqual(nearest, last));
    depth[i] = inside ? distorted_depth[nearest.y * width + nearest.x] : 0.0;
}
