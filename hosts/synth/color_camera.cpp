#include "hosts/synth/color_camera.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "hosts/synth/parallel.hpp"
#include "hosts/synth/random.hpp"

namespace posefusion::synth {
namespace {

constexpr float kBlurSigma = 0.5f;  ///< of the lens, pixels
/// Rotated grid: no two samples share a row or column (pixels from the centre).
constexpr std::array<std::array<float, 2>, kColorSamples> kOffsets{
    {{-0.125f, -0.375f}, {0.375f, -0.125f}, {0.125f, 0.375f}, {-0.375f, 0.125f}}};

using LinearImage = Image<std::array<float, 3>>;

/// Linear light to sRGB grey levels 0..255 (not rounded).
float to_srgb(float x) {
    x = std::clamp(x, 0.0f, 1.0f);
    return 255 * (x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f);
}

/// The curve as a table: pow per pixel and channel would cost as much as the rays.
class SrgbTable {
public:
    SrgbTable() {
        for (std::size_t i = 0; i < table_.size(); ++i) {
            const float root = static_cast<float>(i) / static_cast<float>(kSteps);
            table_[i] = to_srgb(root * root);
        }
    }
    [[nodiscard]] float operator()(float x) const {
        const float at = std::sqrt(std::clamp(x, 0.0f, 1.0f)) * static_cast<float>(kSteps);
        const auto i = std::min(static_cast<std::size_t>(at), kSteps - 1);
        return mix_value(table_[i], table_[i + 1], at - static_cast<float>(i));
    }

private:
    static constexpr std::size_t kSteps =
        1024;  ///< evenly spaced in the square root, where the curve is nearly straight
    std::array<float, kSteps + 1> table_{};
};

LinearImage blurred(const LinearImage& in) {
    const float side = std::exp(-0.5f / (kBlurSigma * kBlurSigma)), norm = 1 / (1 + 2 * side);
    const auto pass = [&](const LinearImage& image, int du, int dv) {
        LinearImage out(image.width(), image.height());
        for (int v = 0; v < image.height(); ++v)
            for (int u = 0; u < image.width(); ++u) {
                const auto& a = image(std::max(u - du, 0), std::max(v - dv, 0));
                const auto& b = image(std::min(u + du, image.width() - 1), std::min(v + dv, image.height() - 1));
                const auto& c = image(u, v);
                for (std::size_t k = 0; k < 3; ++k) out(u, v)[k] = norm * (c[k] + side * (a[k] + b[k]));
            }
        return out;
    };
    return pass(pass(in, 1, 0), 0, 1);
}

}  // namespace

ColorImage photograph(const Scene& scene, const Crowd& crowd, const SensorUnit& sensor,
                      const std::vector<RollingView>& views, const Vector3f& gain,
                      const std::optional<Exposure>& exposure, std::uint64_t seed, int threads) {
    const Intrinsics& camera = sensor.camera().intrinsics;
    LinearImage light(camera.width, camera.height);
    const float footprint = 0.7f / camera.fx;
    parallel_for(camera.height, threads, [&](int v) {
        for (int u = 0; u < camera.width; ++u) {
            Vector3f sum = Vector3f::Zero();
            for (std::size_t s = 0; s < kColorSamples; ++s) {
                const RowView& row = views[s][static_cast<std::size_t>(v)];
                const Isometry3f& pose = row.T_world_camera;
                const Moment now(crowd, row.moment);
                const Vector3f ray =
                    sensor.ray(static_cast<float>(u) + kOffsets[s][0], static_cast<float>(v) + kOffsets[s][1]);
                const Vector3f direction = pose.linear() * ray, origin = pose.translation();
                const std::uint64_t bits =
                    (hash(seed, static_cast<std::uint64_t>(u), static_cast<std::uint64_t>(v)) & ~3ull) | s;
                const Vector3f arriving =
                    scene.radiance(now, scene.trace(now, origin, direction), origin, direction, footprint, bits);
                sum += arriving.cwiseProduct(gain).cwiseMin(1.5f);  // highlights clip before they bleed over edges
            }
            sum *= sensor.vignetting(static_cast<float>(u), static_cast<float>(v)) / kColorSamples;
            light(u, v) = {sum.x(), sum.y(), sum.z()};
        }
    });
    if (exposure) light = blurred(light);
    static const SrgbTable srgb;
    ColorImage image(camera.width, camera.height);
    parallel_for(camera.height, threads, [&](int v) {
        for (int u = 0; u < camera.width; ++u) {
            std::array<std::uint8_t, 3> value{};
            for (std::size_t k = 0; k < 3; ++k) {
                float grey = srgb(light(u, v)[k]);
                if (exposure)
                    grey += exposure->grey_noise * to_normal(hash(seed ^ 0xC0FFEE, static_cast<std::uint64_t>(u),
                                                                  static_cast<std::uint64_t>(v), k));
                value[k] = static_cast<std::uint8_t>(std::clamp(grey + 0.5f, 0.0f, 255.0f));
            }
            image(u, v) = {value[0], value[1], value[2]};
        }
    });
    return image;
}

}  // namespace posefusion::synth
