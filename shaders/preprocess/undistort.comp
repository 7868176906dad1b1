#version 460
// Undoes the distortion of a lens: every pixel looks up what the distorted image shows of its ray. Colour is
// interpolated, with positions in whole 1/32 pixels and weights in whole 1/1024, so that every device gives the same
// bytes; beyond the border it is that of the border, which makes no gradient. Depth is that of the nearest pixel, since
// a mean of two surfaces lies on neither; beyond the border it is 0.
// push: size of both images, pixels
// in:  lens [n] (u, v) pixels, distorted_color [n] r | g << 8 | b << 16, distorted_depth [n]
// out: color [n], depth [n]
layout(local_size_x = 64) in;
layout(push_constant) uniform Push { int width, height; };
layout(std430, binding = 0) readonly buffer Lens { vec2 lens[]; };
layout(std430, binding = 1) readonly buffer DistortedColor { uint distorted_color[]; };
layout(std430, binding = 2) readonly buffer DistortedDepth { float distorted_depth[]; };
layout(std430, binding = 3) writeonly buffer Color { uint color[]; };
layout(std430, binding = 4) writeonly buffer Depth { float depth[]; };

const int FRACTION_BITS = 5;
const int FRACTIONS = 1 << FRACTION_BITS;

uvec3 color_at(int u, int v) {
    uint c = distorted_color[clamp(v, 0, height - 1) * width + clamp(u, 0, width - 1)];
    return uvec3(c, c >> 8, c >> 16) & 255u;
}

void main() {
    uint first = gl_WorkGroupID.x * 256u + gl_LocalInvocationID.x;
    for (uint k = 0u; k < 4u; ++k) {
        uint i = first + k * 64u;
        if (i >= uint(width * height)) return;
        vec2 p = clamp(lens[i], vec2(-2.0), vec2(width + 1, height + 1));  // two pixels off is as good as far off

        ivec2 fine = ivec2(roundEven(p * float(FRACTIONS)));
        ivec2 corner = fine >> FRACTION_BITS;
        uvec2 to = uvec2(fine & (FRACTIONS - 1)), from = uint(FRACTIONS) - to;
        uvec3 sum = from.y * (from.x * color_at(corner.x, corner.y) + to.x * color_at(corner.x + 1, corner.y)) +
                    to.y * (from.x * color_at(corner.x, corner.y + 1) + to.x * color_at(corner.x + 1, corner.y + 1));
        uvec3 mean = (sum + uint(FRACTIONS * FRACTIONS / 2)) >> (2 * FRACTION_BITS);
        color[i] = mean.r | mean.g << 8 | mean.b << 16;

        ivec2 nearest = ivec2(roundEven(p));
        bool inside = nearest.x >= 0 && nearest.y >= 0 && nearest.x < width && nearest.y < height;
        depth[i] = inside ? distorted_depth[nearest.y * width + nearest.x] : 0.0;
    }
}
