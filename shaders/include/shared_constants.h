// Numbers that C++ and GLSL share: this file is compiled by both. Those of a configuration are in Params instead.
// C++ includes it through engine/vulkan/shared_types.hpp, which defines uint.
#ifndef POSEFUSION_SHARED_CONSTANTS_H
#define POSEFUSION_SHARED_CONSTANTS_H

const uint PIXELS_PER_INVOCATION = 4u;  // of preprocess/static_depth and, side by side, of preprocess/bilateral

#endif
