#include "hosts/synth/exposure_course.hpp"

#include <algorithm>
#include <cmath>

namespace posefusion::synth {
namespace {

constexpr int kColumns = 16, kRows = 12;          ///< spots that are metered
constexpr float kMiddleWeight = 2;                ///< of a spot in the middle; 1 at the border
constexpr float kDarkest = 0.002f;                ///< a view is never taken to be darker
const Vector3f kLuma(0.2126f, 0.7152f, 0.0722f);  ///< ITU-R BT.709

}  // namespace

float metered_brightness(const Scene& scene, const Moment& now, const SensorUnit& sensor,
                         const Isometry3f& T_world_camera) {
    const Intrinsics& camera = sensor.camera().intrinsics;
    const Vector3f origin = T_world_camera.translation();
    const float pitch = static_cast<float>(camera.width) / kColumns, footprint = pitch / camera.fx;
    float sum = 0, weights = 0;
    for (int row = 0; row < kRows; ++row)
        for (int column = 0; column < kColumns; ++column) {
            const float x = (static_cast<float>(column) + 0.5f) / kColumns,
                        y = (static_cast<float>(row) + 0.5f) / kRows;
            const Vector3f direction = T_world_camera.linear() * sensor.ray(x * static_cast<float>(camera.width),
                                                                            y * static_cast<float>(camera.height));
            const Vector3f light =
                scene.radiance(now, scene.trace(now, origin, direction), origin, direction, footprint, 0);
            const float off = std::max(std::abs(2 * x - 1), std::abs(2 * y - 1));
            const float weight = mix_value(kMiddleWeight, 1, off);
            sum += weight * std::min(light.dot(kLuma), 1.0f), weights += weight;
        }
    return sum / weights;
}

ExposureCourse::ExposureCourse(const ExposureControl& control, const std::vector<float>& brightness, double fps,
                               std::uint64_t seed)
    : control_(control),
      fps_(fps),
      wander_(hash(seed, 1), 1 / static_cast<double>(control.wander_s)),
      balance_(hash(seed, 2), 1 / static_cast<double>(control.balance_s)) {
    const auto stops = [](float light) { return std::log2(std::max(light, kDarkest)); };
    const float step = 1 - std::exp(-1 / static_cast<float>(fps) / control.lag_s);
    float ev = 0;
    for (const float seen : brightness) {
        // What a frame shows decides the exposure of the next ones.
        followed_ev_.push_back(ev);
        const float wanted = control.follow * (stops(brightness.front()) - stops(seen));
        ev += step * (std::clamp(wanted, -control.range_ev, control.range_ev) - ev);
    }
}

float ExposureCourse::gain(int frame) const {
    const float followed = followed_ev_.empty() ? 0 : followed_ev_[static_cast<std::size_t>(frame)];
    return std::exp2(followed + control_.wander_ev * static_cast<float>(wander_(frame / fps_)));
}

Vector3f ExposureCourse::channels(int frame) const {
    const float tint = std::exp2(control_.balance_ev * static_cast<float>(balance_(frame / fps_)));
    return gain(frame) * Vector3f(tint, 1, 1 / tint);
}

}  // namespace posefusion::synth
