// Rigid transforms (struct Pose) and their exponential map.
#ifndef POSEFUSION_SE3
#define POSEFUSION_SE3
#include "shared_types.h"

const float SMALL_ANGLE2 = 1e-6;         // radians^2; below it the series is exact in floats, and nothing is 0 / 0
const uint EXPONENT_BITS = 0x7f800000u;  // all set: infinite or not a number

vec3 transform(Pose T, vec3 p) {
    vec4 h = vec4(p, 1.0);
    return vec3(dot(T.row0, h), dot(T.row1, h), dot(T.row2, h));
}

vec3 rotate(Pose T, vec3 v) {
    return vec3(dot(T.row0.xyz, v), dot(T.row1.xyz, v), dot(T.row2.xyz, v));
}

vec3 translation(Pose T) {
    return vec3(T.row0.w, T.row1.w, T.row2.w);
}

Pose identity_pose() {
    return Pose(vec4(1, 0, 0, 0), vec4(0, 1, 0, 0), vec4(0, 0, 1, 0));
}

// A transform from the rows of its rotation and a translation.
Pose make_pose(vec3 r0, vec3 r1, vec3 r2, vec3 t) {
    return Pose(vec4(r0, t.x), vec4(r1, t.y), vec4(r2, t.z));
}

Pose inverse_pose(Pose T) {
    vec3 c0 = vec3(T.row0.x, T.row1.x, T.row2.x);
    vec3 c1 = vec3(T.row0.y, T.row1.y, T.row2.y);
    vec3 c2 = vec3(T.row0.z, T.row1.z, T.row2.z);
    vec3 t = translation(T);
    return make_pose(c0, c1, c2, -vec3(dot(c0, t), dot(c1, t), dot(c2, t)));
}

// a * b
Pose compose(Pose a, Pose b) {
    return Pose(a.row0.x * b.row0 + a.row0.y * b.row1 + a.row0.z * b.row2 + vec4(0, 0, 0, a.row0.w),
                a.row1.x * b.row0 + a.row1.y * b.row1 + a.row1.z * b.row2 + vec4(0, 0, 0, a.row1.w),
                a.row2.x * b.row0 + a.row2.y * b.row1 + a.row2.z * b.row2 + vec4(0, 0, 0, a.row2.w));
}

// Makes the rotation orthonormal again (Gram-Schmidt on the rows; the error of one composition is at rounding level).
Pose orthonormalised(Pose T) {
    vec3 r0 = normalize(T.row0.xyz);
    vec3 r1 = normalize(T.row1.xyz - dot(T.row1.xyz, r0) * r0);
    return make_pose(r0, r1, cross(r0, r1), translation(T));
}

// Rotation exp([w]x) by Rodrigues, translation v taken as it is (first order is enough: steps are small and repeated).
Pose exp_pose(vec3 v, vec3 w) {
    float angle2 = dot(w, w);
    float a, b;  // sin(angle)/angle, (1-cos(angle))/angle^2
    if (angle2 < SMALL_ANGLE2) {
        a = 1.0 - angle2 / 6.0;
        b = 0.5 - angle2 / 24.0;
    } else {
        float angle = sqrt(angle2);
        a = sin(angle) / angle;
        b = (1.0 - cos(angle)) / angle2;
    }
    vec3 r0 = vec3(1.0 - b * (w.y * w.y + w.z * w.z), b * w.x * w.y - a * w.z, b * w.x * w.z + a * w.y);
    vec3 r1 = vec3(b * w.x * w.y + a * w.z, 1.0 - b * (w.x * w.x + w.z * w.z), b * w.y * w.z - a * w.x);
    vec3 r2 = vec3(b * w.x * w.z - a * w.y, b * w.y * w.z + a * w.x, 1.0 - b * (w.x * w.x + w.y * w.y));
    return make_pose(r0, r1, r2, v);
}

float rotation_angle(Pose T) {
    vec3 axis = 0.5 * vec3(T.row2.y - T.row1.z, T.row0.z - T.row2.x, T.row1.x - T.row0.y);
    float cosine = 0.5 * (T.row0.x + T.row1.y + T.row2.z - 1.0);
    return atan(length(axis), cosine);
}

// Rotation vector: axis times angle. Angles near pi are not needed.
vec3 log_rotation(Pose T) {
    vec3 axis = 0.5 * vec3(T.row2.y - T.row1.z, T.row0.z - T.row2.x, T.row1.x - T.row0.y);  // times sin(angle)
    float sine = length(axis);
    float cosine = 0.5 * (T.row0.x + T.row1.y + T.row2.z - 1.0);
    return sine > 1e-4 ? axis * (atan(sine, cosine) / sine) : axis;  // too small to divide by
}

// Tested by the bits: GLSL guarantees neither comparisons with NaN nor that atan propagates it.
bool is_finite(Pose T) {
    float sum = dot(T.row0, T.row0) + dot(T.row1, T.row1) + dot(T.row2, T.row2);
    return (floatBitsToUint(sum) & EXPONENT_BITS) != EXPONENT_BITS;
}

#endif
