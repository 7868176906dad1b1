#include "hosts/export/view.hpp"

#include <algorithm>

#include "engine/core/pinhole.hpp"
#include "hosts/io/lens.hpp"

namespace posefusion {
namespace {

/// Lens models hold within the image. Farther out their polynomials turn back and would place points in the image that
/// are far outside of it; no lens that is calibrated here moves a point by more than this part of the image.
constexpr float kFarthestOutside = 0.25f;

/// Labels of whole rows (step 1) or columns (step = width) spread by `margin`. @param length  of a line
void spread(const std::uint8_t* from, std::uint8_t* to, int length, std::ptrdiff_t step, int margin) {
    int last = -margin - 1;  // place of the last label so far
    for (int i = 0; i < length; ++i) {
        if (from[i * step] != 0) last = i;
        to[i * step] = i - last <= margin ? from[last * step] : std::uint8_t{0};
    }
    last = length + margin;
    for (int i = length - 1; i >= 0; --i) {
        if (from[i * step] != 0) last = i;
        if (to[i * step] == 0 && last - i <= margin) to[i * step] = from[last * step];
    }
}

}  // namespace

std::optional<Eigen::Vector2f> pixel_of(const Eigen::Vector3f& point, const Camera& camera) {
    if (!(point.z() > 0)) return std::nullopt;
    const Intrinsics& K = camera.intrinsics;
    const Eigen::Vector2f ideal = project(point, K);
    const Eigen::Vector2f size(static_cast<float>(K.width), static_cast<float>(K.height));
    const Eigen::Vector2f outside = kFarthestOutside * size;
    if ((ideal.array() < -outside.array()).any() || (ideal.array() > (size + outside).array()).any())
        return std::nullopt;
    const PlanePoint p = distort({point.x() / point.z(), point.y() / point.z()}, camera.distortion);
    const Eigen::Vector2f pixel = project(Eigen::Vector3f(p.x, p.y, 1), K);
    if (!in_image(pixel, K)) return std::nullopt;
    return pixel;
}

LabelImage grown(const LabelImage& labels, int margin) {
    LabelImage wide(labels.width(), labels.height()), both(labels.width(), labels.height());
    for (int v = 0; v < labels.height(); ++v) spread(&labels(0, v), &wide(0, v), labels.width(), 1, margin);
    for (int u = 0; u < labels.width(); ++u) spread(&wide(u, 0), &both(u, 0), labels.height(), labels.width(), margin);
    return both;
}

LabelImage usable_pixels(const View& view) {
    LabelImage usable(view.color.width(), view.color.height());
    for (std::size_t i = 0; i < usable.size(); ++i) usable[i] = view.people.empty() || view.people[i] == 0 ? 255 : 0;
    return usable;
}

}  // namespace posefusion
