#include "hosts/synth/texture.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace posefusion::synth {
namespace {

/// sRGB byte to linear light.
const std::array<float, 256>& linear_table() {
    static const std::array<float, 256> table = [] {
        std::array<float, 256> t{};
        for (std::size_t i = 0; i < t.size(); ++i) {
            const float x = static_cast<float>(i) / 255;
            t[i] = x <= 0.04045f ? x / 12.92f : std::pow((x + 0.055f) / 1.055f, 2.4f);
        }
        return t;
    }();
    return table;
}

std::uint8_t to_byte(float x) { return static_cast<std::uint8_t>(std::clamp(x, 0.0f, 1.0f) * 255 + 0.5f); }

ColorImage half_size(const ColorImage& in) {
    ColorImage out(std::max(in.width() / 2, 1), std::max(in.height() / 2, 1));
    for (int v = 0; v < out.height(); ++v)
        for (int u = 0; u < out.width(); ++u) {
            int r = 2, g = 2, b = 2;
            for (int dv = 0; dv < 2; ++dv)
                for (int du = 0; du < 2; ++du) {
                    const Rgb8 p = in(std::min(2 * u + du, in.width() - 1), std::min(2 * v + dv, in.height() - 1));
                    r += p.r, g += p.g, b += p.b;
                }
            out(u, v) = {static_cast<std::uint8_t>(r / 4), static_cast<std::uint8_t>(g / 4),
                         static_cast<std::uint8_t>(b / 4)};
        }
    return out;
}

int wrap(int i, int n) { return i < 0 ? i + n : i >= n ? i - n : i; }

}  // namespace

Texture::Texture(const Vector2f& span, int pixels_per_metre, const std::function<Vector3f(float, float)>& paint,
                 bool emits)
    : span_(span), texel_(1.0f / static_cast<float>(pixels_per_metre)), emits_(emits) {
    ColorImage image(std::max(static_cast<int>(span.x() / texel_ + 0.5f), 1),
                     std::max(static_cast<int>(span.y() / texel_ + 0.5f), 1));
    for (int v = 0; v < image.height(); ++v)
        for (int u = 0; u < image.width(); ++u) {
            const Vector3f c = paint((static_cast<float>(u) + 0.5f) * texel_, (static_cast<float>(v) + 0.5f) * texel_);
            image(u, v) = {to_byte(c.x()), to_byte(c.y()), to_byte(c.z())};
        }
    levels_.push_back(std::move(image));
    while (levels_.back().width() > 1 && levels_.back().height() > 1) levels_.push_back(half_size(levels_.back()));
}

Vector3f Texture::bilinear(const ColorImage& level, const Vector2f& uv) const {
    const Vector2f turns = uv.cwiseQuotient(span_);
    const float x = (turns.x() - std::floor(turns.x())) * static_cast<float>(level.width()) - 0.5f;
    const float y = (turns.y() - std::floor(turns.y())) * static_cast<float>(level.height()) - 0.5f;
    const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
    const float ax = x - static_cast<float>(x0), ay = y - static_cast<float>(y0);
    const auto& linear = linear_table();
    const auto at = [&](int dx, int dy) {
        const Rgb8 p = level(wrap(x0 + dx, level.width()), wrap(y0 + dy, level.height()));
        return Vector3f(linear[p.r], linear[p.g], linear[p.b]);
    };
    return (1 - ay) * ((1 - ax) * at(0, 0) + ax * at(1, 0)) + ay * ((1 - ax) * at(0, 1) + ax * at(1, 1));
}

Vector3f Texture::sample(const Vector2f& uv, float footprint) const {
    const float level =
        std::clamp(std::log2(std::max(footprint / texel_, 1e-6f)), 0.0f, static_cast<float>(levels_.size() - 1));
    const auto fine = static_cast<std::size_t>(level);
    const float between = level - static_cast<float>(fine);
    const Vector3f sharp = bilinear(levels_[fine], uv);
    if (between < 0.05f || fine + 1 >= levels_.size()) return sharp;
    return (1 - between) * sharp + between * bilinear(levels_[fine + 1], uv);
}

}  // namespace posefusion::synth
