#pragma once
#include <Eigen/Geometry>

#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"

namespace posefusion {

/// Pixels from (left, top) to before (right, bottom).
struct PixelRange {
    int left = 0, top = 0, right = 0, bottom = 0;

    [[nodiscard]] bool empty() const { return right <= left || bottom <= top; }
    void include(int u, int v);
    void include(const PixelRange& other);
};

/// The part of an image that an object is tracked in. It has the same size for all objects, less than half of the
/// image: a window at full resolution where the object fits into it, else every second pixel of the image.
struct ObjectView {
    Intrinsics camera;  ///< of the window
    int left = 0, top = 0;
    int stride = 1;  ///< pixel (u, v) of the window is pixel (left + stride u, top + stride v) of the image

    /// Size of the window for images of `camera`.
    [[nodiscard]] static Intrinsics largest(const Intrinsics& camera);
    /// A view that holds `range`, with some room around it.
    [[nodiscard]] static ObjectView around(const PixelRange& range, const Intrinsics& image);

    [[nodiscard]] int u_of(int column) const { return left + stride * column; }
    [[nodiscard]] int v_of(int row) const { return top + stride * row; }
    /// @param outside  of pixels that the image does not have
    template <class Pixel>
    [[nodiscard]] Image<Pixel> cut(const Image<Pixel>& image, Pixel outside = {}) const {
        Image<Pixel> window(camera.width, camera.height, outside);
        for (int y = 0; y < camera.height; ++y)
            for (int x = 0; x < camera.width; ++x)
                if (image.contains(u_of(x), v_of(y))) window(x, y) = image(u_of(x), v_of(y));
        return window;
    }
};

}  // namespace posefusion
