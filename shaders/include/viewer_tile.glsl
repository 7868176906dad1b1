// Where a tile lies and what it shows, byte by byte as hosts/viewer/scene_renderer.cpp has it.
layout(push_constant) uniform Tile {
    vec4 place;         // left, top, width, height in pixels of the window
    vec2 window;        // pixels
    uint width, height; // of the image, pixels
    uint content;       // 0 colour, 1 depth, 2 predicted colour, 3 predicted depth
    uint show_mask;     // 1: people are tinted
    float depth_max;    // metres
} tile;
