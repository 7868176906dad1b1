// The viewing camera.
#ifndef POSEFUSION_VIEWER_VIEW
#define POSEFUSION_VIEWER_VIEW
#include "include/viewer_types.h"

readonly buffer ViewBuffer { View view; };

vec3 to_camera(vec3 p) { return (view.T_camera_world * vec4(p, 1.0)).xyz; }
vec3 turn(vec3 d) { return mat3(view.T_camera_world) * d; }

// Depth is near / z: 1 at the near plane, 0 at infinity, equally exact everywhere in float.
vec4 to_clip(vec3 p) {
    return vec4(2.0 * (view.focal * p.xy + view.centre * p.z) / view.size, view.near, p.z);
}

#endif
