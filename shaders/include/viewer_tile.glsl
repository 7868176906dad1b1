#include "include/viewer_types.h"
layout(push_constant) uniform TileConstants { TileView tile; };
