#include "pose/network_input.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace posefusion {

InputSize fit_network_input(int image_width, int image_height, InputSize fixed, int long_side, int stride) {
    const double factor = static_cast<double>(long_side) / std::max(image_width, image_height);
    const auto fit = [&](int fixed_extent, int extent) {
        if (fixed_extent > 0) return fixed_extent;
        return std::max(1, static_cast<int>(std::lround(extent * factor / stride))) * stride;
    };
    return {fit(fixed.width, image_width), fit(fixed.height, image_height)};
}

Tensor make_network_input(const ColorImage& image, InputSize size, const PixelFormat& format) {
    // The header only borrows the pixels, which are not written to.
    const cv::Mat pixels(image.height(), image.width(), CV_8UC3, const_cast<Rgb8*>(image.data()));
    cv::Mat resized;
    const bool shrinks = size.width <= image.width() && size.height <= image.height();
    cv::resize(pixels, resized, {size.width, size.height}, 0, 0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);

    Tensor input(3, size.height, size.width);
    for (int channel = 0; channel < 3; ++channel) {
        float* out = input.plane(format.bgr ? 2 - channel : channel);
        for (int y = 0; y < size.height; ++y) {
            const cv::Vec3b* row = resized.ptr<cv::Vec3b>(y);
            for (int x = 0; x < size.width; ++x)
                *out++ = static_cast<float>(row[x][channel]) * format.scale + format.offset;
        }
    }
    return input;
}

}  // namespace posefusion
