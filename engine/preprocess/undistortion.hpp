#pragma once
#include <cstddef>
#include <memory>

#include "engine/core/image.hpp"
#include "engine/core/lens_map.hpp"

namespace posefusion {

namespace vulkan {
class Context;
}

/// Undoes the distortion of a lens on the device. Its results go back to the host, since people are looked for there.
/// Colour is interpolated and continues beyond the border, depth is that of the nearest pixel and 0 beyond: every
/// device gives the same bytes, those of OpenCV's remap().
class Undistortion {
public:
    /// Larger images are too much for one kernel of the device.
    [[nodiscard]] static std::size_t most_pixels(const vulkan::Context& context);
    /// @param context  may be one that a Slam works with at the same time (Slam::context())
    /// Throws Error: the map is empty, too large or holds what is no finite number, the device has no memory left.
    Undistortion(std::shared_ptr<vulkan::Context> context, const LensMap& lens);
    ~Undistortion();
    Undistortion(Undistortion&&) noexcept;
    Undistortion& operator=(Undistortion&&) noexcept;

    /// Both images of a frame in place, of the map's size. One submission, which waits for what the device has been
    /// told to do before: a frame of Slam at most. May be called by several threads. Throws Error: images of another
    /// size, device lost.
    UndistortTime apply(ColorImage& color, DepthImage& depth) const;

private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

}  // namespace posefusion
