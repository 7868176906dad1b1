#pragma once
#include "engine/core/image.hpp"

namespace posefusion {

/// The map rendered from a pose (splat prediction).
struct ModelView {
    ColorImage color;
    DepthImage depth;
};

}  // namespace posefusion
