// Data that the viewer passes to its shaders, compiled by both C++ (hosts/viewer/draw_types.hpp) and GLSL. GLSL lays
// the structures out by the rules of std430; draw_types.hpp checks that C++ does the same.
#ifndef POSEFUSION_VIEWER_TYPES_H
#define POSEFUSION_VIEWER_TYPES_H

const uint COLOR_PHOTO = 0u;       // as the camera saw it
const uint COLOR_NORMAL = 1u;      // direction of the surface, world frame
const uint COLOR_CONFIDENCE = 2u;  // dark: new; bright: twice the confidence of a stable surfel
const uint COLOR_AGE = 3u;         // bright: just seen; dark: not seen for long
const uint COLOR_TIME = 4u;        // dark: made early; bright: made late

// What the viewing camera sees and how.
struct View {
    mat4 T_camera_world;      // world -> viewing camera (x right, y down, z forward; metres)
    vec2 focal;               // pixels
    vec2 size;                // of the window, pixels
    vec2 centre;              // where the optical axis meets the window, pixels from its middle
    float near;               // metres
    float min_confidence;     // surfels below this are not drawn
    float stable_confidence;  // surfels are stable from here on
    float now;                // number of the newest frame
    float age_scale;          // frames until a surfel is as dark as it gets
    uint color_mode;          // COLOR_*
    uint stride;              // every stride-th surfel is drawn, larger
    uint unused[3];
};

// A line of some width in the world; one without length becomes a square.
struct Segment {
    vec3 from;    // world, metres
    float width;  // pixels
    vec3 to;      // world, metres
    uint color;   // r | g << 8 | b << 16
};

const uint TILE_COLOR = 0u;
const uint TILE_DEPTH = 1u;
const uint TILE_PREDICTED_COLOR = 2u;
const uint TILE_PREDICTED_DEPTH = 3u;
const uint TILE_CONTENTS = 4u;  // number of contents

// Where an image lies in the window and what it shows.
struct TileView {
    vec4 place;          // left, top, width, height in pixels of the window
    vec2 window;         // size, pixels
    uint width, height;  // of the image, pixels
    uint content;        // TILE_*
    uint show_mask;      // 1: people and what else moves are tinted
    float depth_max;     // metres, far end of the colour scale
    uint unused;
};

#endif
