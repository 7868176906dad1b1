#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/color.glsl"
#include "include/colormap.glsl"
#include "include/shared_constants.h"
#include "include/viewer_types.h"
// An image of a snapshot, straight from its buffer.
readonly buffer Tiles { TileView tiles[]; };
readonly buffer Color { uint live_color[]; };
readonly buffer Depth { float live_depth[]; };
readonly buffer ModelColor { uint model_color[]; };
readonly buffer ModelDepth { float model_depth[]; };
readonly buffer Tints { uint tints[]; };  // r | g << 8 | b << 16 of each label
layout(location = 0) in vec2 in_position;
layout(location = 1) flat in uint in_tile;
layout(location = 0) out vec4 color;

const vec3 NOTHING = vec3(0.05);  // for unknown pixels: nearly black

vec3 depth_color(float z, float depth_max) { return z > 0.0 ? viridis(1.0 - z / depth_max) : NOTHING; }

void main() {
    TileView tile = tiles[in_tile];
    uvec2 at = min(uvec2(in_position * vec2(tile.width, tile.height)), uvec2(tile.width - 1u, tile.height - 1u));
    uint i = at.y * tile.width + at.x;
    vec3 shown;
    switch (tile.content) {
        case TILE_COLOR: {
            uint pixel = live_color[i];
            shown = unpack_color(pixel);
            uint label = tag_of(pixel);
            if (tile.show_mask != 0u && label != 0u) shown = mix(shown, unpack_color(tints[label]), 0.5);
            break;
        }
        case TILE_DEPTH: shown = depth_color(live_depth[i], tile.depth_max); break;
        case TILE_PREDICTED_COLOR:
            shown = tag_of(model_color[i]) != SOURCE_NONE ? unpack_color(model_color[i]) : NOTHING;
            break;
        default: shown = depth_color(model_depth[i], tile.depth_max); break;
    }
    color = vec4(shown, 1.0);
}
