#include "engine/objects/object_view.hpp"

#include <algorithm>
#include <cmath>

namespace posefusion {
namespace {

constexpr int kMultiple = 8;                     ///< of sizes: a pyramid of three levels halves them twice
constexpr float kWidth = 0.5f, kHeight = 0.75f;  ///< of the window, in the image: carts, doors and chairs stand upright
constexpr int kRoom = 24;                        ///< share of the image's width, 1 / kRoom, around an object

int part_of(int size, float part) {
    return (static_cast<int>(std::lround(part * static_cast<float>(size))) + kMultiple - 1) / kMultiple * kMultiple;
}

}  // namespace

void PixelRange::include(int u, int v) { include({u, v, u + 1, v + 1}); }

void PixelRange::include(const PixelRange& other) {
    if (other.empty()) return;
    if (empty()) {
        *this = other;
        return;
    }
    left = std::min(left, other.left), top = std::min(top, other.top);
    right = std::max(right, other.right), bottom = std::max(bottom, other.bottom);
}

Intrinsics ObjectView::largest(const Intrinsics& camera) {
    Intrinsics window = camera;
    window.width = part_of(camera.width, kWidth), window.height = part_of(camera.height, kHeight);
    return window;
}

ObjectView ObjectView::around(const PixelRange& range, const Intrinsics& image) {
    ObjectView view;
    view.camera = largest(image);
    const int room = image.width / kRoom;
    const int width = range.right - range.left + 2 * room, height = range.bottom - range.top + 2 * room;
    // what reaches over the border of the image needs no room there
    if (std::min(width, image.width) <= view.camera.width && std::min(height, image.height) <= view.camera.height) {
        const auto begin = [](int from, int to, int window, int size) {
            return std::clamp((from + to - window) / 2, 0, std::max(0, size - window));
        };
        view.left = begin(range.left, range.right, view.camera.width, image.width);
        view.top = begin(range.top, range.bottom, view.camera.height, image.height);
    } else {
        view.stride = 2;
    }
    const auto stride = static_cast<float>(view.stride);
    view.camera.fx = image.fx / stride, view.camera.fy = image.fy / stride;
    view.camera.cx = (image.cx - static_cast<float>(view.left)) / stride;
    view.camera.cy = (image.cy - static_cast<float>(view.top)) / stride;
    return view;
}

}  // namespace posefusion
