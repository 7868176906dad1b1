#pragma once
#include <opencv2/core/types.hpp>

#include "engine/core/image.hpp"

namespace posefusion {

/// A colour as OpenCV's drawing functions take it, for images whose channels are red, green, blue.
[[nodiscard]] inline cv::Scalar scalar(Rgb8 c) {
    return {static_cast<double>(c.r), static_cast<double>(c.g), static_cast<double>(c.b)};
}

}  // namespace posefusion
