// What the viewer's camera sees and how, byte by byte as hosts/viewer/scene_renderer.cpp has it.
#ifndef POSEFUSION_VIEWER_VIEW
#define POSEFUSION_VIEWER_VIEW

layout(std430, set = 0, binding = 0) readonly buffer ViewBuffer {
    vec4 row0, row1, row2;  // world -> viewing camera (x right, y down, z forward; metres)
    vec2 focal;             // pixels
    vec2 size;              // of the window, pixels
    float near;             // metres
    float min_confidence;   // surfels below this are not drawn
    float stable_confidence;
    float now;              // number of the newest frame
    uint color_mode;        // 0 photo, 1 normal, 2 confidence, 3 age, 4 time
    float age_scale;        // frames
    uint stride;            // of the surfels every so many-th is drawn, larger
    uint unused;
    vec2 centre;            // where the optical axis meets the window, pixels from its middle
} view;

vec3 to_camera(vec3 p) {
    vec4 h = vec4(p, 1.0);
    return vec3(dot(view.row0, h), dot(view.row1, h), dot(view.row2, h));
}
vec3 turn(vec3 d) { return vec3(dot(view.row0.xyz, d), dot(view.row1.xyz, d), dot(view.row2.xyz, d)); }

// Depth is near / z: 1 at the near plane, 0 at infinity, equally exact everywhere in float.
vec4 to_clip(vec3 p) {
    return vec4(2.0 * (view.focal * p.xy + view.centre * p.z) / view.size, view.near, p.z);
}

#endif
