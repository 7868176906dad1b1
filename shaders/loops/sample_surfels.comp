#version 460
#extension GL_GOOGLE_include_directive : require
#include "include/shared_types.h"
// Every `stride`-th slot of the map, offered as a node of the deformation graph.
// push: stride; number of samples
layout(local_size_x = GROUP) in;
layout(push_constant) uniform Push { uint stride; uint count; };
readonly buffer Positions { vec4 position_confidence[]; };
readonly buffer Appearances { uvec4 appearance[]; };
writeonly buffer Samples { SurfelSample samples[]; };

void main() {
    uint i = gl_GlobalInvocationID.x;
    if (i >= count) return;
    uint s = i * stride;
    samples[i] = SurfelSample(position_confidence[s], appearance[s][CREATED], appearance[s][LAST_SEEN], 0u, 0u);
}
