#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
// Takes the appended surfels into the map and sets the dispatch arguments of the kernels that run once per surfel.
layout(local_size_x = 1) in;
layout(push_constant) uniform Push { uint surfels_per_group; };
layout(std430, binding = 0) buffer Map { MapRecord map; };
layout(std430, binding = 1) writeonly buffer Arguments { DispatchArguments arguments[]; };

void main() {
    map.count += map.appended;
    map.appended = 0u;
    map.alive = 0u;
    map.stable = 0u;
    map.inactive_in_view = 0u;
    arguments[0] = DispatchArguments((map.count + surfels_per_group - 1u) / surfels_per_group, 1u, 1u);
}
