#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/viewer_types.h"
// A rectangle of the window, as a strip of four vertices.
// in:  tiles, an instance each
// out: position in the image, 0..1; index of the tile
readonly buffer Tiles { TileView tiles[]; };
layout(location = 0) out vec2 out_position;
layout(location = 1) flat out uint out_tile;

void main() {
    TileView tile = tiles[gl_InstanceIndex];
    out_tile = uint(gl_InstanceIndex);
    out_position = vec2(gl_VertexIndex & 1, gl_VertexIndex >> 1);
    vec2 pixel = tile.place.xy + out_position * tile.place.zw;
    gl_Position = vec4(2.0 * pixel / tile.window - 1.0, 1.0, 1.0);
}
