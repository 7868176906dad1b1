#include "engine/slam/input_checks.hpp"

#include <cmath>
#include <string>

#include "engine/core/error.hpp"
#include "engine/core/number_text.hpp"

namespace posefusion {
namespace {

constexpr int kMinSize = 16;  // pixels: the coarsest level still has neighbours

void check_size(int width, int height, const Intrinsics& camera, const char* what) {
    if (width == camera.width && height == camera.height) return;
    throw Error(std::string("the ") + what + " image is " + std::to_string(width) + "x" + std::to_string(height) +
                " but the camera is " + std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                "; correct the image or the camera file");
}

std::string text_of(const Intrinsics& camera) {
    return std::to_string(camera.width) + "x" + std::to_string(camera.height) + " with fx " + shortest_text(camera.fx) +
           ", fy " + shortest_text(camera.fy) + ", cx " + shortest_text(camera.cx) + ", cy " + shortest_text(camera.cy);
}

}  // namespace

const Intrinsics& checked(const Intrinsics& camera) {
    if (!camera.valid()) throw Error("camera: width, height, fx and fy must be positive; correct the camera file");
    for (const float value : {camera.fx, camera.fy, camera.cx, camera.cy}) {
        if (!std::isfinite(value))
            throw Error("camera: fx, fy, cx and cy must be finite numbers; correct the camera file");
    }
    if (camera.width % 4 != 0 || camera.height % 4 != 0) {
        throw Error("camera: images of " + std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                    " cannot be used, width and height must be multiples of 4; crop or scale them");
    }
    if (camera.width < kMinSize || camera.height < kMinSize) {
        throw Error("camera: images of " + std::to_string(camera.width) + "x" + std::to_string(camera.height) +
                    " are too small, at least " + std::to_string(kMinSize) +
                    " pixels are needed either way; use a larger --scale");
    }
    return camera;
}

const SlamConfig& checked(const SlamConfig& config) {
    if (config.tracking.full_resolution_step < 1 || config.tracking.full_resolution_step > 2) {
        throw Error("tracking.full_resolution_step is " + std::to_string(config.tracking.full_resolution_step) +
                    ", it must be 1 or 2");
    }
    if (config.map.index_map_scale < 1 || config.map.index_map_scale > 8) {
        throw Error("map.index_map_scale is " + std::to_string(config.map.index_map_scale) + ", it must be 1 to 8");
    }
    return config;
}

void check_sizes(const Intrinsics& camera, const ColorImage& color, const DepthImage& depth, const LabelImage& labels) {
    check_size(color.width(), color.height(), camera, "colour");
    check_size(depth.width(), depth.height(), camera, "depth");
    if (!labels.empty()) check_size(labels.width(), labels.height(), camera, "label");
}

void check_same_camera(const Intrinsics& is, const Intrinsics& was) {
    if (is == was) return;
    throw Error("the map was made with another camera: " + text_of(was) + ", not " + text_of(is) +
                "; use that camera and the same --scale");
}

}  // namespace posefusion
