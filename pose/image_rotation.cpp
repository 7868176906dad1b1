#include "pose/image_rotation.hpp"

#include <algorithm>
#include <opencv2/core.hpp>
#include <utility>

namespace posefusion {
namespace {

struct Point {
    float u, v;
};

/// Of the rotated image, in an image of that size.
Point rotated_back(Point point, ImageRotation rotation, int width, int height) {
    const auto right = static_cast<float>(width - 1), bottom = static_cast<float>(height - 1);
    switch (rotation) {
        case ImageRotation::Clockwise90:
            return {point.v, bottom - point.u};
        case ImageRotation::Half:
            return {right - point.u, bottom - point.v};
        case ImageRotation::Clockwise270:
            return {right - point.v, point.u};
        default:
            return point;
    }
}

}  // namespace

ColorImage rotated(const ColorImage& image, ImageRotation rotation) {
    if (rotation == ImageRotation::None) return image;
    const bool exchanges_sides = rotation != ImageRotation::Half;
    ColorImage result(exchanges_sides ? image.height() : image.width(),
                      exchanges_sides ? image.width() : image.height());
    // The header only borrows the pixels, which are not written to.
    const cv::Mat from(image.height(), image.width(), CV_8UC3, const_cast<Rgb8*>(image.data()));
    cv::Mat to(result.height(), result.width(), CV_8UC3, result.data());
    const int code = rotation == ImageRotation::Half          ? cv::ROTATE_180
                     : rotation == ImageRotation::Clockwise90 ? cv::ROTATE_90_CLOCKWISE
                                                              : cv::ROTATE_90_COUNTERCLOCKWISE;
    cv::rotate(from, to, code);
    return result;
}

People rotated_back(People people, ImageRotation rotation, int width, int height) {
    for (Person& person : people) {
        for (JointObservation& joint : person.joints) {
            const Point point = rotated_back({joint.u, joint.v}, rotation, width, height);
            if (joint.p > 0) joint = {point.u, point.v, joint.p};
        }
        if (person.box.empty()) continue;
        const Point a = rotated_back({person.box.u_min, person.box.v_min}, rotation, width, height);
        const Point b = rotated_back({person.box.u_max, person.box.v_max}, rotation, width, height);
        person.box = {std::min(a.u, b.u), std::min(a.v, b.v), std::max(a.u, b.u), std::max(a.v, b.v)};
    }
    return people;
}

}  // namespace posefusion
