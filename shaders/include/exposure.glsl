// Colours of one exposure: auto exposure and white balance change what a camera makes of the same surface.
#ifndef POSEFUSION_EXPOSURE
#define POSEFUSION_EXPOSURE
#include "color.glsl"
#include "shared_types.h"

// A pixel of the live image as the camera would have seen it with the exposure of the map: what that would have clipped
// is white.
vec3 in_map_exposure(TrackingRecord record, uint pixel) {
    return min(record.exposure.rgb * unpack_color(pixel), vec3(1.0));
}

#endif
