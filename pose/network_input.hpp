#pragma once
#include "engine/core/image.hpp"
#include "pose/runtime.hpp"
#include "pose/tensor.hpp"

namespace posefusion {

/// How a network wants its pixels: value * scale + offset, in this order of channels.
struct PixelFormat {
    bool bgr = false;
    float scale = 1;
    float offset = 0;
};

/// The size to which an image is shrunk (or stretched) before a network.
/// Without fixed size: the long side becomes `long_side`, both sides the nearest multiple of `stride` (at least one),
/// so that the aspect ratio is kept up to this rounding. Black bars are not an option: some networks normalise over the
/// whole image.
[[nodiscard]] InputSize fit_network_input(int image_width, int image_height, InputSize fixed, int long_side,
                                          int stride);

/// The network's input. Shrinks by area averaging, enlarges bilinearly.
[[nodiscard]] Tensor make_network_input(const ColorImage& image, InputSize size, const PixelFormat& format);

}  // namespace posefusion
