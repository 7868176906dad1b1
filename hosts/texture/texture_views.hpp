#pragma once
#include <cstddef>
#include <functional>

#include "engine/core/intrinsics.hpp"
#include "hosts/export/view.hpp"

namespace posefusion {

/// Where the colours of a texture come from: images of one ideal camera, loaded one at a time.
struct TextureViews {
    Intrinsics camera;
    std::size_t count = 0;
    /// A view whose size is that of the camera; its depth may be empty. Throws Error.
    std::function<View(std::size_t)> load;
};

}  // namespace posefusion
