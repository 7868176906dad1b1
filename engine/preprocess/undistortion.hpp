#pragma once
#include <cstddef>
#include <memory>

#include "engine/core/image.hpp"
#include "engine/core/lens_map.hpp"

namespace posefusion {

namespace vulkan {
class Context;
}

/// Undistorts images on the device. The results are copied back to the host, which detects people in them. Colour is
/// interpolated and repeats its border, depth is that of the nearest pixel and 0 outside. Every device gives the same
/// bytes, those of OpenCV's remap().
class Undistortion {
public:
    /// Largest supported image: larger ones exceed one dispatch.
    [[nodiscard]] static std::size_t most_pixels(const vulkan::Context& context);
    /// @param context  may be in use by a Slam at the same time (Slam::context())
    /// Throws Error: the map is empty, too large or not finite, or the device is out of memory.
    Undistortion(std::shared_ptr<vulkan::Context> context, const LensMap& lens);
    ~Undistortion();
    Undistortion(Undistortion&&) noexcept;
    Undistortion& operator=(Undistortion&&) noexcept;

    /// Undistorts both images of a frame in place; they must have the map's size. One submission, which waits for the
    /// device's earlier work: at most one frame of Slam. Thread-safe. Throws Error: images of another size, device
    /// lost.
    UndistortTime apply(ColorImage& color, DepthImage& depth) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace posefusion
