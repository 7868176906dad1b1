#pragma once
#include "engine/core/image.hpp"

namespace posefusion {

/// A place between the pixels of an image; the centre of the top left pixel is (0, 0).
struct PixelPosition {
    float u = 0, v = 0;  ///< pixels
};

/// Of every pixel of an image without lens distortion: where the same ray meets the image with it. Finite; what lies
/// outside that image may be anywhere outside.
using LensMap = Image<PixelPosition>;

}  // namespace posefusion
