#pragma once
#include "engine/core/image.hpp"

namespace posefusion {

/// What the map looks like from a pose (splat prediction).
struct ModelView {
    ColorImage color;
    DepthImage depth;
};

}  // namespace posefusion
