#pragma once
#include <array>

#include "engine/core/image.hpp"
#include "pose/joints.hpp"

namespace posefusion {

/// By how many quarter turns clockwise an image is rotated.
enum class ImageRotation { None, Clockwise90, Half, Clockwise270 };

[[nodiscard]] constexpr int degrees_of(ImageRotation rotation) { return 90 * static_cast<int>(rotation); }
/// Both, one after the other.
[[nodiscard]] constexpr ImageRotation operator+(ImageRotation a, ImageRotation b) {
    return static_cast<ImageRotation>((static_cast<int>(a) + static_cast<int>(b)) % 4);
}

[[nodiscard]] ColorImage rotated(const ColorImage& image, ImageRotation rotation);

/// People found in the rotated image, in pixels of the image itself. @param width, height  of the image itself
[[nodiscard]] People rotated_back(People people, ImageRotation rotation, int width, int height);

}  // namespace posefusion
