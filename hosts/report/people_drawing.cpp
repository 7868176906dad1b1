#include "hosts/report/people_drawing.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "engine/core/error.hpp"
#include "hosts/report/person_colors.hpp"
#include "hosts/report/scalar.hpp"

namespace posefusion {
namespace {

constexpr Rgb8 kBone{255, 255, 255}, kJoint{220, 20, 60};

bool on_outline(const LabelImage& labels, int u, int v) {
    for (const auto& [du, dv] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
        if (labels.contains(u + du, v + dv) && labels(u + du, v + dv) != labels(u, v)) return true;
    return false;
}

void tint(ColorImage& image, const LabelImage& labels) {
    const auto half = [](std::uint8_t a, std::uint8_t b) { return static_cast<std::uint8_t>((a + b) / 2); };
    for (int v = 0; v < image.height(); ++v) {
        for (int u = 0; u < image.width(); ++u) {
            if (labels(u, v) == 0) continue;
            const Rgb8 paint = label_color(labels(u, v));
            Rgb8& c = image(u, v);
            c = on_outline(labels, u, v) ? paint : Rgb8{half(c.r, paint.r), half(c.g, paint.g), half(c.b, paint.b)};
        }
    }
}

/// Joints far outside the image (a network may extrapolate them) would overflow OpenCV's fixed-point drawing.
bool drawable(const JointObservation& joint) {
    return joint.p > 0 && std::abs(joint.u) < 1e4f && std::abs(joint.v) < 1e4f;
}

void draw_skeleton(cv::Mat& image, const Person& person) {
    const auto at = [&](int joint) {
        const JointObservation& j = person.joints[static_cast<std::size_t>(joint)];
        return cv::Point(static_cast<int>(std::lround(j.u)), static_cast<int>(std::lround(j.v)));
    };
    const auto found = [&](int joint) { return drawable(person.joints[static_cast<std::size_t>(joint)]); };
    const int thickness = std::max(1, image.cols / 320);
    for (const auto& [a, b] : kLimbs)
        if (found(a) && found(b)) cv::line(image, at(a), at(b), scalar(kBone), thickness, cv::LINE_AA);
    for (int joint = 0; joint < kJointCount; ++joint)
        if (found(joint)) cv::circle(image, at(joint), thickness + 1, scalar(kJoint), cv::FILLED, cv::LINE_AA);
}

}  // namespace

ColorImage draw_people(const ColorImage& color, const LabelImage& labels, const People& people) {
    if (!labels.empty() && (labels.width() != color.width() || labels.height() != color.height()))
        throw Error("mask and picture differ in size");
    ColorImage result = color;
    if (!labels.empty()) tint(result, labels);
    cv::Mat image(result.height(), result.width(), CV_8UC3, result.data());
    for (const Person& person : people) draw_skeleton(image, person);
    return result;
}

}  // namespace posefusion
