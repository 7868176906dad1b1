#pragma once
#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "hosts/io/camera_file.hpp"

/// From the images of a recording to those that are worked on.
namespace posefusion {

/// Undistorts (Brown's model, where the camera is distorted), shrinks by `scale` and crops at the right and bottom to
/// sizes that divide by 4, as the engine needs. Const methods may be called from several threads.
class ImageGeometry {
public:
    ImageGeometry() = default;
    /// @param scale  (0, 1]. Throws Error when it is not, or when less than 4x4 pixels are left.
    ImageGeometry(const Camera& camera, float scale);

    /// Of the resulting images. For a scale of 1/n the same as Intrinsics::scaled.
    [[nodiscard]] const Intrinsics& intrinsics() const { return intrinsics_; }

    /// Bilinear, then area mean.
    [[nodiscard]] ColorImage from_source(ColorImage color) const;
    /// Nearest neighbour, then the mean of the measurements of a block that are close to their median: what lies at
    /// another depth takes no part, so that nothing is put between foreground and background. 0 where less than half of
    /// the block was measured.
    [[nodiscard]] DepthImage from_source(DepthImage depth) const;
    /// Nearest neighbour.
    [[nodiscard]] LabelImage from_source(LabelImage labels) const;
    /// Back again: nearest neighbour; 0 where the source pixel is in no resulting image.
    [[nodiscard]] LabelImage to_source(LabelImage labels) const;

private:
    template <class Pixel>
    [[nodiscard]] Image<Pixel> undistort(Image<Pixel> image) const;

    Intrinsics source_, intrinsics_;
    int used_width_ = 0, used_height_ = 0;    ///< part of the undistorted image that the result covers, pixels
    Image<float> distorted_u_, distorted_v_;  ///< where an ideal pixel is in the source image; empty = no distortion
    Image<float> ideal_u_, ideal_v_;          ///< where a source pixel is in the ideal image
};

}  // namespace posefusion
