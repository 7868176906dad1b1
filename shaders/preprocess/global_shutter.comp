#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/color.glsl"
#include "include/geometry.glsl"
#include "include/noise.glsl"
#include "include/shutter.glsl"
// Turns a frame whose rows were taken one after another, and whose depth was taken at another time than its colour,
// into one taken at the stamp. Backward warping: for each pixel of the result, which pixel of the frame saw that point?
// push: found: 0: by the motion that is expected, 1: by that which tracking has found
// in:  rolling_depth [n] metres, rolling_color [n], record.expected_motion; frame_motion, turn_acceleration
// out: depth [n] at the stamp: interpolated within one surface, 0 where nothing was seen; color [n], the label that of
//      the nearest pixel
layout(local_size_x = 64) in;
layout(push_constant) uniform Push { uint found; };
readonly buffer ParamsBuffer { Params params; };
readonly buffer Record { TrackingRecord record; };
readonly buffer RollingDepth { float rolling_depth[]; };
readonly buffer RollingColor { uint rolling_color[]; };
writeonly buffer Depth { float depth[]; };
writeonly buffer Color { uint color[]; };

// Where the frame, with row v taken at first + v per_row, saw the point that is at `uv` at the stamp. The depth of
// pixels without one is taken to be `z`: it matters little, as most of the effect of the shutter comes from rotation.
vec2 seen_at(Camera c, Twist motion, vec3 acceleration, float first, float per_row, vec2 uv, float z) {
    vec2 source = uv;
    for (uint k = 0u; k < SHUTTER_STEPS; ++k) {
        ivec2 cell = nearest_pixel(c, source);
        float here = in_image(c, cell) ? rolling_depth[index_of(c, cell)] : 0.0;
        z = here > 0.0 ? here : z;
        vec3 p = at_stamp(motion, acceleration, first + source.y * per_row, back_project(c, source, z));
        source += uv - project(c, vec3(p.xy, max(p.z, NEAR_PLANE)));
    }
    return near_image(c, source);
}

// Interpolated where all four pixels around belong to one surface, else that of the nearest.
float depth_at(Camera c, vec2 source) {
    ivec2 cell = nearest_pixel(c, source);
    float nearest = in_image(c, cell) ? rolling_depth[index_of(c, cell)] : 0.0;
    vec2 corner = floor(source);
    ivec2 cell0 = ivec2(corner);
    bool inside = in_image(c, cell0) && in_image(c, cell0 + 1);
    uint i = inside ? index_of(c, cell0) : 0u;
    vec4 z = vec4(rolling_depth[i], rolling_depth[i + 1u], rolling_depth[i + c.width], rolling_depth[i + c.width + 1u]);
    float low = min(min(z.x, z.y), min(z.z, z.w)), high = max(max(z.x, z.y), max(z.z, z.w));
    float slope = STEEPEST_SLOPE * nearest / c.fx;
    bool one_surface = inside && low > 0.0 && high - low < same_surface(params, nearest) + slope;
    vec2 f = source - corner;
    return one_surface ? mix(mix(z.x, z.y, f.x), mix(z.z, z.w, f.x), f.y) : nearest;
}

vec3 color_at(Camera c, vec2 source) {
    vec2 inside = clamp(source, vec2(0.0), vec2(c.width, c.height) - 1.0);
    vec2 corner = min(floor(inside), vec2(c.width, c.height) - 2.0);
    uint i = index_of(c, ivec2(corner));
    vec2 f = inside - corner;
    return mix(mix(unpack_color(rolling_color[i]), unpack_color(rolling_color[i + 1u]), f.x),
               mix(unpack_color(rolling_color[i + c.width]), unpack_color(rolling_color[i + c.width + 1u]), f.x), f.y);
}

void main() {
    Camera c = camera_at(params, 0u);
    uint i = gl_GlobalInvocationID.x;
    if (i >= c.width * c.height) return;
    uint v = i / c.width;
    vec2 uv = vec2(i - v * c.width, v);
    Twist motion = record.expected_motion;
    vec3 acceleration = vec3(0.0);
    if (found != 0u) {
        motion = record.frame_motion;
        acceleration = record.turn_acceleration.xyz;
    }
    float z = rolling_depth[i] > 0.0 ? rolling_depth[i] : SHUTTER_DEPTH;

    vec2 source = seen_at(c, motion, acceleration, params.depth_first_row, params.depth_per_row, uv, z);
    float seen = depth_at(c, source);
    float time = params.depth_first_row + source.y * params.depth_per_row;
    vec3 p = at_stamp(motion, acceleration, time, back_project(c, source, seen));
    depth[i] = seen > 0.0 ? p.z : 0.0;

    source = seen_at(c, motion, acceleration, params.color_first_row, params.color_per_row, uv, z);
    ivec2 nearest = clamp(nearest_pixel(c, source), ivec2(0), ivec2(c.width, c.height) - 1);
    color[i] = pack_color(color_at(c, source), tag_of(rolling_color[index_of(c, nearest)]));
}
