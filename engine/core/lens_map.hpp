#pragma once
#include <optional>

#include "engine/core/image.hpp"

namespace posefusion {

/// A position in an image with sub-pixel precision; the centre of the top left pixel is (0, 0).
struct PixelPosition {
    float u = 0, v = 0;  ///< pixels
};

/// For each pixel of the undistorted image, the position in the distorted image that shows the same ray. Finite; a
/// position outside the distorted image need not be exact.
using LensMap = Image<PixelPosition>;

/// The time that undistorting one frame on a device took.
struct UndistortTime {
    std::optional<double> device_ms;  ///< computing on the device, milliseconds; nullopt: the device has no clock, or
                                      ///< nothing was undistorted
    double wait_ms = 0;               ///< waiting for the device's earlier work, milliseconds; 0 where it has no clock
};

}  // namespace posefusion
