#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
#include "include/geometry.glsl"
#include "include/noise.glsl"
// Normals by a plane fit. On a plane the inverse depth is linear in the pixel, 1/z = d + a du + b dv, and its noise is
// nearly the same everywhere (structured light measures disparity), so plain least squares over the window's pixels on
// the centre's surface is the right fit. Differences of neighbours would only see the sensor's disparity steps.
//   n ~ -(fx a, fy b, d + a (cx - u) + b (cy - v)), towards the camera
// Far away the sensor's noise, correlated over several pixels, tilts even that plane: there the normal is blended with
// that of the next coarser level, the more the greater the expected error.
// push: pyramid level; use_coarse = 1: coarse_geometry is given
// in:  depth    [n] metres, coarse_geometry [n / 4]
// out: geometry [n] (normal or 0, depth)
layout(local_size_x = GROUP) in;
layout(constant_id = 0) const int RADIUS = 1;
layout(push_constant) uniform Push { uint level; uint use_coarse; };
readonly buffer ParamsBuffer { Params params; };
readonly buffer Depth { float depth[]; };
readonly buffer CoarseGeometry { vec4 coarse_geometry[]; };
writeonly buffer Geometry { vec4 geometry[]; };

const float MIN_DETERMINANT = 1e-6;  // pixels^4; no division by 0 where the fit is refused
#include "include/normal_upsampling.glsl"

void main() {
    Camera c = camera_at(params, level);
    int width = int(c.width), height = int(c.height);
    int i = int(gl_GlobalInvocationID.x);
    if (i >= width * height) return;
    int v = i / width, u = i - v * width;
    float z = depth[i];
    float noise = same_surface(params, z);
    float slope = STEEPEST_SLOPE * z / c.fx;

    // moments of (1, du, dv) with weight w, and of the inverse depth relative to the centre's
    float s = 0.0, su = 0.0, sv = 0.0, suu = 0.0, suv = 0.0, svv = 0.0, sd = 0.0, sud = 0.0, svd = 0.0;
    float inverse = z > 0.0 ? 1.0 / z : 0.0;
    for (int dv = -RADIUS; dv <= RADIUS; ++dv) {
        int row = clamp(v + dv, 0, height - 1) * width;
        for (int du = -RADIUS; du <= RADIUS; ++du) {
            float zn = depth[row + clamp(u + du, 0, width - 1)];
            // a border pixel repeated outside of the image would flatten the slope
            bool inside = in_image(c, ivec2(u + du, v + dv));
            bool same = inside && zn > 0.0 && abs(zn - z) < noise + slope * float(max(abs(du), abs(dv)));
            float d = same ? 1.0 / zn - inverse : 0.0;
            float w = float(same);
            float x = float(du), y = float(dv);
            s += w, su += w * x, sv += w * y;
            suu += w * x * x, suv += w * x * y, svv += w * y * y;
            sd += d, sud += x * d, svd += y * d;
        }
    }
    // 3x3 normal equations, the mean eliminated first
    float inv_s = 1.0 / max(s, 1.0);
    float cuu = suu - su * su * inv_s, cuv = suv - su * sv * inv_s, cvv = svv - sv * sv * inv_s;
    float cud = sud - su * sd * inv_s, cvd = svd - sv * sd * inv_s;
    float det = cuu * cvv - cuv * cuv;
    // enough of the window (for a corner pixel a little more than a quarter of it lies in the image), in both
    // directions
    float window = float((2 * RADIUS + 1) * (2 * RADIUS + 1));
    bool fits = z > 0.0 && s >= MIN_PLANE_SHARE * window && det > MIN_PLANE_SPREAD * cuu * cvv;
    float a = (cvv * cud - cuv * cvd) / max(det, MIN_DETERMINANT);
    float b = (cuu * cvd - cuv * cud) / max(det, MIN_DETERMINANT);
    float d0 = inverse + (sd - a * su - b * sv) * inv_s;
    vec3 n = -vec3(c.fx * a, c.fy * b, d0 + a * (c.cx - float(u)) + b * (c.cy - float(v)));
    n = fits ? normalize(n) : vec3(0.0);
    if (use_coarse != 0u && z > 0.0) {
        float error = depth_sigma(params, z) * c.fx / (z * float(2 * RADIUS + 1));
        float weight = error * error / (TOLERABLE_NORMAL_ERROR * TOLERABLE_NORMAL_ERROR);
        n = direction_of(n + weight * upsampled_normal(u, v, width, height, z, c.fx));
    }
    geometry[i] = vec4(n, z);
}
