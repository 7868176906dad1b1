#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_KHR_shader_subgroup_arithmetic : require
#include "include/shared_types.h"
#include "include/geometry.glsl"
#include "include/noise.glsl"
#include "include/se3.glsl"
#include "include/reduction.glsl"
#include "include/shutter.glsl"
// Normal equations of one Gauss-Newton step: projective point-to-plane ICP and the photometric term, each with Cauchy
// weights and divided by its own standard deviation, so that they can be added.
//   q = T_model_live p,  geometric:   r = n . (q - m)              J = [n, q x n]
//                        photometric: r = I_model(pi(q)) - g I_live   J = [a, q x a], a = (d pi / d q)^T grad I
// The gain g is what the camera's exposure has changed since the frame before, estimated with the pose.
// With a rolling shutter p was seen at the time of its row, separately for depth and colour: it is moved by the motion
// that the frame has not been corrected for yet (motion_error, updated with the pose in every step).
// TURN: also the system of a turn that is faster at the stamp than the pose says, and of its acceleration: rows turn by
// their time, and by half of its square.
// push: pyramid level; step: 1 takes every pixel, 2 every second one, as on a chequerboard
// in:  live and model geometry (normal, depth) and photometric (intensity or -1, gradient) images, record.model_live
// out: rows with columns COLUMN_*, row_counts
layout(local_size_x = REDUCTION_GROUP) in;
layout(constant_id = 0) const uint ROLLING = 0;
layout(constant_id = 1) const uint TIMING = 0;
layout(constant_id = 2) const uint TURN = 0;
const uint COLUMNS = TIMING != 0u ? TIMING_COLUMNS : TURN != 0u ? TURN_COLUMNS : REDUCTION_COLUMNS;
layout(push_constant) uniform Push { uint level; uint step; };
readonly buffer ParamsBuffer { Params params; };
readonly buffer LiveGeometry { vec4 live_geometry[]; };
readonly buffer LivePhotometric { vec4 live_photometric[]; };
readonly buffer ModelGeometry { vec4 model_geometry[]; };
readonly buffer ModelPhotometric { vec4 model_photometric[]; };
readonly buffer Record { TrackingRecord record; };
writeonly buffer Rows { float rows[]; };
writeonly buffer RowCounts { uint row_counts[]; };

const float MIN_RANGE2 = 1e-6;  // square metres; pixels without depth have neither range nor weight

void main() {
    Camera c = camera_at(params, level);
    uint n = c.width * c.height;
    Pose T = record.model_live;
    float gain = record.photometric_gain;
    float icp_cut = params.icp_robust * record.icp_scale;
    float photometric_sigma = record.photometric_scale;
    float photometric_cut = params.photometric_robust * photometric_sigma;

    Twist motion_error = record.motion_error;
    vec3 acceleration = record.turn_acceleration.xyz;
    float rows_per_row = float(1u << level);  // rows of the full resolution per row of this level

    float times[TIMING_COLUMNS - COLUMN_POSE_DELAY];
    for (uint k = 0u; k < TIMING_COLUMNS - COLUMN_POSE_DELAY; ++k) times[k] = 0.0;
    float turns[TURN_COLUMNS - COLUMN_POSE_TURN];
    for (uint k = 0u; k < TURN_COLUMNS - COLUMN_POSE_TURN; ++k) turns[k] = 0.0;
    float H[SYSTEM_COLUMNS];
    for (uint k = 0u; k < SYSTEM_COLUMNS; ++k) H[k] = 0.0;
    float icp_sum = 0.0, icp_count = 0.0, icp_squares = 0.0, live_count = 0.0;
    float photometric_sum = 0.0, photometric_count = 0.0, photometric_squares = 0.0;
    float live_intensity = 0.0, model_intensity = 0.0;

    uint first = gl_WorkGroupID.x * REDUCTION_PIXELS_PER_GROUP + gl_LocalInvocationID.x;
    for (uint k = 0u; k < REDUCTION_PIXELS; ++k) {
        uint sample_index = (first + k * REDUCTION_GROUP) * step;
        bool counted = sample_index < n;
        sample_index = min(sample_index, n - 1u);
        uint v = sample_index / c.width;
        uint i = min(sample_index + (step > 1u ? v & 1u : 0u), n - 1u);
        vec4 live = live_geometry[i];
        float z = live.w;
        vec3 p = back_project(c, vec2(i - v * c.width, v), z);
        vec3 p_shade = p;
        float row = (float(v) + 0.5) * rows_per_row - 0.5;
        float rows_at = (row + 0.5) / float(params.height) - params.stamp_row;
        if (ROLLING != 0u) {
            p_shade = at_stamp(motion_error, acceleration, params.color_first_row + row * params.color_per_row, p);
            p = at_stamp(motion_error, acceleration, params.depth_first_row + row * params.depth_per_row, p);
        }
        vec3 q = transform(T, p);
        bool valid = counted && z > 0.0 && q.z > NEAR_PLANE;
        vec2 uv = project(c, vec3(q.xy, max(q.z, NEAR_PLANE)));
        ivec2 cell = nearest_pixel(c, uv);
        valid = valid && in_image(c, cell);
        uint j = valid ? index_of(c, cell) : 0u;
        vec4 model = model_geometry[j];
        vec3 m = back_project(c, vec2(cell), model.w);
        vec3 gap = q - m;
        float sigma_z = depth_sigma(params, z);

        // geometric
        vec3 normal = model.xyz;
        vec3 live_normal = rotate(T, live.xyz);
        bool associated = valid && model.w > 0.0 &&
                          dot(gap, gap) <= params.icp_max_distance * params.icp_max_distance &&
                          dot(normal, live_normal) >= params.icp_min_cosine;  // false where a normal is unknown (0)
        float cosine = dot(normal, q) * inversesqrt(max(dot(q, q), MIN_RANGE2));
        float lateral = params.lateral_noise * z / params.fx;
        float variance = sigma_z * sigma_z * cosine * cosine + lateral * lateral * (1.0 - cosine * cosine) +
                         params.noise_floor * params.noise_floor;
        float inverse_sigma = inversesqrt(variance);
        float use = associated ? params.icp_enabled : 0.0;
        float r = use * dot(normal, gap);
        float whitened = r * inverse_sigma / icp_cut;
        float w = use * inverse_sigma * inverse_sigma /
                  (record.icp_scale * record.icp_scale * (1.0 + whitened * whitened));
        vec3 moment = cross(q, normal);
        float J[6] = float[6](normal.x, normal.y, normal.z, moment.x, moment.y, moment.z);
        ACCUMULATE_6(H, J, w, r)
        if (TURN != 0u) {
            float time = params.depth_first_row + row * params.depth_per_row;
            ACCUMULATE_TURN(turns, J, w * time, time, r)
        }
        if (TIMING != 0u) {
            // a point that was taken later is moved by the camera's motion in that time
            vec3 moves = moved_per_second(T, record.last_motion, p);
            vec3 model_moves = moved_per_second(identity_pose(), record.expected_motion, m);
            float model_row = (float(cell.y) + 0.5) / float(c.height) - params.stamp_row;
            float slope = dot(normal, moves - model_moves);
            float row_slope = dot(normal, rows_at * moves - model_row * model_moves);
            float ws = w * slope, wsr = w * row_slope;
            for (uint m = 0u; m < 6u; ++m) {
                times[m] += ws * J[m];
                times[6u + m] += wsr * J[m];
            }
            times[18] += ws * slope, times[19] += wsr * slope, times[20] += wsr * row_slope;
            times[22] += ws * r, times[23] += wsr * r;
        }
        icp_sum += abs(r) * inverse_sigma;
        icp_count += use;
        icp_squares += r * r;
        live_count += float(counted && z > 0.0);

        // photometric, bilinear in the model image
        vec4 shade = live_photometric[i];
        if (ROLLING != 0u) {
            q = transform(T, p_shade);
            uv = project(c, vec3(q.xy, max(q.z, NEAR_PLANE)));
        }
        vec2 corner = floor(near_image(c, uv));
        ivec2 cell0 = ivec2(corner);
        bool inside = valid && in_image(c, cell0) && in_image(c, cell0 + 1);
        uint j0 = inside ? index_of(c, cell0) : 0u;
        vec2 f = uv - corner;
        vec4 s00 = model_photometric[j0], s10 = model_photometric[j0 + 1u];
        vec4 s01 = model_photometric[j0 + c.width], s11 = model_photometric[j0 + c.width + 1u];
        vec3 s = mix(mix(s00.xyz, s10.xyz, f.x), mix(s01.xyz, s11.xyz, f.x), f.y);
        bool known = min(min(s00.x, s10.x), min(s01.x, s11.x)) >= 0.0 && shade.x >= 0.0;
        bool visible = model.w > 0.0 && abs(q.z - model.w) < VISIBLE_DEPTH + SAME_SURFACE_SIGMAS * sigma_z;
        vec2 gradient = 0.5 * (s.yz + gain * shade.yz);
        bool textured = dot(gradient, gradient) > params.min_gradient * params.min_gradient;
        float use_shade = inside && known && visible && textured && params.photometric_weight > 0.0 ? 1.0 : 0.0;
        float rp = use_shade * (s.x - gain * shade.x);
        float ratio = rp / photometric_cut;
        float robust = use_shade / (1.0 + ratio * ratio);
        float wp = robust * params.photometric_weight / (photometric_sigma * photometric_sigma);
        vec3 a = vec3(c.fx * gradient.x, c.fy * gradient.y, 0.0) / max(q.z, NEAR_PLANE);
        a.z = -(a.x * q.x + a.y * q.y) / max(q.z, NEAR_PLANE);
        vec3 moment_p = cross(q, a);
        float Jp[6] = float[6](a.x, a.y, a.z, moment_p.x, moment_p.y, moment_p.z);
        ACCUMULATE_6(H, Jp, wp, rp)
        if (TURN != 0u) {
            float time = params.color_first_row + row * params.color_per_row;
            ACCUMULATE_TURN(turns, Jp, wp * time, time, rp)
        }
        if (TIMING != 0u) {
            float model_row = (uv.y + 0.5) / float(c.height) - params.stamp_row;
            float slope = dot(a, rows_at * moved_per_second(T, record.last_motion, p_shade) -
                                 model_row * moved_per_second(identity_pose(), record.expected_motion, q));
            float wsr = wp * slope;
            for (uint m = 0u; m < 6u; ++m) times[12u + m] += wsr * Jp[m];
            times[21] += wsr * slope;
            times[24] += wsr * rp;
        }
        photometric_sum += abs(rp);
        photometric_count += use_shade;
        photometric_squares += rp * rp;
        live_intensity += robust * shade.x;
        model_intensity += robust * s.x;
    }

    uint row = REDUCTION_ROW_OF(COLUMNS);
    bool writer = subgroupElect();
    for (uint k = 0u; k < SYSTEM_COLUMNS; ++k) {
        float sum = subgroupAdd(H[k]);
        if (writer) rows[row + COLUMN_HESSIAN + k] = sum;
    }
    const uint judged = TRACK_COLUMNS - COLUMN_ICP_ABS;
    float tail[judged] = float[judged](icp_sum, icp_count, icp_squares, photometric_sum, photometric_count,
                                       photometric_squares, live_count, live_intensity, model_intensity);
    for (uint k = 0u; k < judged; ++k) {
        float sum = subgroupAdd(tail[k]);
        if (writer) rows[row + COLUMN_ICP_ABS + k] = sum;
    }
    if (TIMING != 0u) {
        for (uint k = 0u; k < TIMING_COLUMNS - COLUMN_POSE_DELAY; ++k) {
            float sum = subgroupAdd(times[k]);
            if (writer) rows[row + COLUMN_POSE_DELAY + k] = sum;
        }
    }
    if (TURN != 0u) {
        for (uint k = 0u; k < TURN_COLUMNS - COLUMN_POSE_TURN; ++k) {
            float sum = subgroupAdd(turns[k]);
            if (writer) rows[row + COLUMN_POSE_TURN + k] = sum;
        }
    }
    if (writer && gl_SubgroupID == 0u) row_counts[gl_WorkGroupID.x] = gl_NumSubgroups;
}
