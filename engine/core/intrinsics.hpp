#pragma once
/// Pinhole camera. Pixel-centre convention of the whole project, in C++ and GLSL alike: the centre of the
/// top-left pixel is (u, v) = (0, 0), so a pixel index IS its centre and K projects to it without a half pixel.
/// Camera frame: x right, y down, z forward, metres.
namespace posefusion {

/// Lengths in pixels in the configuration are meant for images of this width, and are scaled to that of the camera.
inline constexpr float kReferenceWidth = 640;

struct Intrinsics {
    float fx = 0, fy = 0;       ///< focal lengths in pixels, positive
    float cx = 0, cy = 0;       ///< principal point in pixels
    int width = 0, height = 0;  ///< image size in pixels

    /// The camera of an image shrunk by `factor` (0.5 halves), each output pixel covering 1/factor input pixels.
    /// A pixel block keeps its centre: u' = (u + 0.5) * factor - 0.5.
    [[nodiscard]] Intrinsics scaled(float factor) const {
        return {fx * factor,
                fy * factor,
                (cx + 0.5f) * factor - 0.5f,
                (cy + 0.5f) * factor - 0.5f,
                static_cast<int>(static_cast<float>(width) * factor),
                static_cast<int>(static_cast<float>(height) * factor)};
    }
    friend bool operator==(const Intrinsics&, const Intrinsics&) = default;
    [[nodiscard]] bool valid() const { return fx > 0 && fy > 0 && width > 0 && height > 0; }
};

}  // namespace posefusion
