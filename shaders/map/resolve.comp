#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/depth_test_read.glsl"
#include "include/exposure.glsl"
#include "include/geometry.glsl"
#include "include/se3.glsl"
#include "include/surfel.glsl"
// Prediction, second half: the winning surfel of each pixel becomes geometry and intensity of the model; where no
// surfel was drawn the live frame fills in (fill_in = 1), so that tracking sees a full image from the first frame on.
// out: model_geometry [n] (normal, depth) in the camera frame, model_intensity [n] or -1, model_depth [n],
//      model_color [n], tagged with the source
layout(local_size_x = GROUP) in;
layout(constant_id = 0) const uint CELL_STRIDE = 1;
layout(push_constant) uniform Push { uint fill_in; };
readonly buffer ParamsBuffer { Params params; };
readonly buffer Record { TrackingRecord record; };
readonly buffer CellIndices { uint cell_indices[]; };
readonly buffer Positions { vec4 position_confidence[]; };
readonly buffer Normals { vec4 normal_radius[]; };
readonly buffer Appearances { uvec4 appearance[]; };
readonly buffer LiveGeometry { vec4 live_geometry[]; };
readonly buffer Color { uint color[]; };
writeonly buffer ModelGeometry { vec4 model_geometry[]; };
writeonly buffer ModelIntensity { float model_intensity[]; };
writeonly buffer ModelDepth { float model_depth[]; };
writeonly buffer ModelColor { uint model_color[]; };

#include "include/disc.glsl"

void main() {
    Camera c = camera_at(params, 0u);
    Pose T_camera_world = inverse_pose(record.world_live);
    uint i = gl_GlobalInvocationID.x;
    if (i >= c.width * c.height) return;
    uint v = i / c.width;
    uint s = CELL_INDEX(i);
    vec4 shape = vec4(0.0);
    float shade = -1.0;
    uint look;
    if (s != EMPTY_CELL) {
        vec3 normal = rotate(T_camera_world, normal_radius[s].xyz);
        vec3 centre = transform(T_camera_world, position_confidence[s].xyz);
        // if a compiler rounds differently here than in `splat`, the ray may miss the disc at its rim: depth 0, not
        // drawn
        shape = vec4(normal, disc_hit(c, vec2(i - v * c.width, v), centre, normal, normal_radius[s].w).x);
    }
    if (shape.w > 0.0) {
        vec3 rgb = surfel_color(appearance[s]);
        shade = luma(rgb);
        look = pack_color(rgb, SOURCE_MAP);
    } else {
        shape = fill_in != 0u && record.failed == 0u ? live_geometry[i] : vec4(0.0);
        vec3 rgb = in_map_exposure(record, color[i]);
        shade = shape.w > 0.0 ? luma(rgb) : -1.0;
        look = shape.w > 0.0 ? pack_color(rgb, SOURCE_LIVE) : with_tag(0u, SOURCE_NONE);
    }
    model_geometry[i] = shape;
    model_depth[i] = shape.w;
    model_intensity[i] = shade;
    model_color[i] = look;
}
