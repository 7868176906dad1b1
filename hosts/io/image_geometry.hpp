#pragma once
#include <functional>

#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "engine/core/lens_map.hpp"
#include "hosts/io/camera_file.hpp"

/// From the images of a recording to those that are processed.
namespace posefusion {

/// Undistorts a frame's images in place; thread-safe.
using Undistorter = std::function<UndistortTime(ColorImage& color, DepthImage& depth)>;

/// Undistorts (where the camera is distorted), shrinks by `scale` and crops at the right and bottom to
/// sizes that divide by 4, as the engine needs. Const methods may be called from several threads.
class ImageGeometry {
public:
    ImageGeometry() = default;
    /// @param scale  (0, 1]. Throws Error when it is not, or when fewer than 4x4 pixels are left.
    ImageGeometry(const Camera& camera, float scale);

    /// Of the resulting images. For a scale of 1/n the same as Intrinsics::scaled.
    [[nodiscard]] const Intrinsics& intrinsics() const { return intrinsics_; }

    /// Of the recorded images, empty without distortion.
    [[nodiscard]] const LensMap& lens() const { return lens_; }
    /// From now on `undistorter` undistorts the images of frames instead of the CPU; it must give the same bytes.
    /// Labels, which are rare and small, are still undistorted on the CPU.
    void undistort_by(Undistorter undistorter) { undistorter_ = std::move(undistorter); }

    struct FrameImages {
        ColorImage color;
        DepthImage depth;
        UndistortTime undistort;  ///< zero where the CPU did it, or there is no distortion
    };
    /// Both images as below.
    [[nodiscard]] FrameImages from_source(ColorImage color, DepthImage depth) const;
    /// Bilinear, then area mean.
    [[nodiscard]] ColorImage from_source(ColorImage color) const;
    /// Nearest neighbour, then the mean of the measurements of a block that are close to their median, so that
    /// foreground and background are never mixed. 0 where less than half of the block was measured.
    [[nodiscard]] DepthImage from_source(DepthImage depth) const;
    /// Nearest neighbour.
    [[nodiscard]] LabelImage from_source(LabelImage labels) const;
    /// The inverse: nearest neighbour; 0 where the source pixel is outside of the resulting image.
    [[nodiscard]] LabelImage to_source(LabelImage labels) const;

private:
    template <class Pixel>
    [[nodiscard]] Image<Pixel> undistort(Image<Pixel> image) const;
    [[nodiscard]] ColorImage shrink(ColorImage color) const;
    [[nodiscard]] DepthImage shrink(DepthImage depth) const;

    Intrinsics source_, intrinsics_;
    int used_width_ = 0, used_height_ = 0;  ///< part of the undistorted image that the result covers, pixels
    LensMap lens_;                          ///< empty = no distortion
    Image<float> deformation_;              ///< of depth, in the undistorted image; empty = none
    LensMap to_ideal_;                      ///< the inverse: position of a source pixel in the undistorted image
    Undistorter undistorter_;               ///< empty = the CPU
};

}  // namespace posefusion
