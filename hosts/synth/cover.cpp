#include "hosts/synth/cover.hpp"

#include <algorithm>
#include <cmath>

#include "hosts/synth/random.hpp"

namespace posefusion::synth {
namespace {

constexpr float kDistance = 0.05f;                     ///< metres
constexpr float kSoftEdge = 0.10f, kWavyEdge = 0.12f;  ///< of the image height
constexpr float kDark = 14, kFolds = 9;                ///< grey levels of 255
constexpr float kStray = 0.008f;                       ///< probability of a wrong value per block
constexpr int kStrayBlock = 4;                         ///< pixels of a 640-pixel image
constexpr float kStrayRange = 0.3f;                    ///< metres from the nearest distance on

}  // namespace

float Cover::at(int u, int v, int width, int height) const {
    const float across = static_cast<float>(u) / static_cast<float>(width),
                y = static_cast<float>(v) / static_cast<float>(height);
    const float wave = kWavyEdge * (value_noise(seed_, 4 * across, 0) - 0.5f);
    // From below the image to above it.
    const float margin = kSoftEdge + kWavyEdge, edge = 1 + margin - share_ * (1 + 2 * margin) + wave;
    return smoothstep(edge - 0.5f * kSoftEdge, edge + 0.5f * kSoftEdge, y);
}

void Cover::hide(ExactView& view) const {
    for (int v = 0; v < view.depth.height(); ++v)
        for (int u = 0; u < view.depth.width(); ++u)
            if (at(u, v, view.depth.width(), view.depth.height()) > 0.5f)
                view.depth(u, v) = kDistance, view.labels(u, v) = 0;
}

void Cover::darken(ColorImage& color) const {
    for (int v = 0; v < color.height(); ++v)
        for (int u = 0; u < color.width(); ++u) {
            const float cloth = at(u, v, color.width(), color.height());
            const float x = static_cast<float>(u) / static_cast<float>(color.width()),
                        y = static_cast<float>(v) / static_cast<float>(color.width());
            const float grey = kDark + kFolds * (value_noise(seed_ + 1, 3 * x + y, 2 * y) - 0.5f);
            for (std::uint8_t* c : {&color(u, v).r, &color(u, v).g, &color(u, v).b})
                *c = static_cast<std::uint8_t>(std::lround(mix_value(static_cast<float>(*c), grey, cloth)));
        }
}

void Cover::disturb(DepthImage& depth, const DepthSensorModel& sensor, std::uint64_t frame_seed) const {
    const int block = std::max(kStrayBlock * depth.width() / sensor.reference_width, 1);
    for (int v = 0; v < depth.height(); ++v)
        for (int u = 0; u < depth.width(); ++u) {
            if (at(u, v, depth.width(), depth.height()) <= 0.5f) continue;
            const std::uint64_t h =
                hash(frame_seed, static_cast<std::uint64_t>(u / block), static_cast<std::uint64_t>(v / block));
            depth(u, v) = to_uniform(h) < kStray ? sensor.nearest + kStrayRange * to_uniform(mix(h)) : 0.0f;
        }
}

}  // namespace posefusion::synth
