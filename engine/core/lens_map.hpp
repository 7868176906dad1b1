#pragma once
#include <optional>

#include "engine/core/image.hpp"

namespace posefusion {

/// A place between the pixels of an image; the centre of the top left pixel is (0, 0).
struct PixelPosition {
    float u = 0, v = 0;  ///< pixels
};

/// Of every pixel of an image without lens distortion: where the same ray meets the image with it. Finite; what lies
/// outside that image may be anywhere outside.
using LensMap = Image<PixelPosition>;

/// What it cost to undo the lens of a frame on a device.
struct UndistortTime {
    std::optional<double> device_ms;  ///< the device's own work, milliseconds; nullopt: it has no clock, or had no work
    double wait_ms = 0;               ///< until the device had ended other work, milliseconds; 0 where it has no clock
};

}  // namespace posefusion
