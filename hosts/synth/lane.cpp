#include "hosts/synth/lane.hpp"

#include <algorithm>
#include <cmath>

#include "hosts/synth/random.hpp"

namespace posefusion::synth {
namespace {

constexpr float kSpacing = 0.01f;        ///< metres between the points kept
constexpr float kSmoothHeading = 0.40f;  ///< the heading is that between two points so far apart, metres

}  // namespace

Lane::Lane(const Vector2f& middle, const Vector2f& half, float corner, float start_x) {
    const Vector2f straight = 2 * (half - Vector2f::Constant(corner));
    const float arc = 0.5f * kPi * corner, total = 2 * straight.sum() + 4 * arc;
    const int count = static_cast<int>(std::ceil(total / kSpacing));
    spacing_ = total / static_cast<float>(count);
    const float to_first_corner = start_x - (middle.x() - half.x() + corner);
    for (int i = 0; i < count; ++i) {
        // Measured from the end of the start's straight, so that the sides are straight, arc, straight, arc, ...
        float s = static_cast<float>(i) * spacing_ + straight.x() - to_first_corner;
        Vector2f at(middle.x() + 0.5f * straight.x(), middle.y() - half.y());
        float yaw = kPi;
        s = std::fmod(s, total);
        for (int side = 0;; ++side) {
            const float length = side % 2 == 0 ? straight.x() : straight.y();
            const Vector2f ahead(std::cos(yaw), std::sin(yaw)), right(ahead.y(), -ahead.x());
            if (s <= length) {
                at += s * ahead;
                break;
            }
            at += length * ahead;
            s -= length;
            if (s <= arc) {
                const float angle = s / corner;
                at += corner * (std::sin(angle) * ahead + (1 - std::cos(angle)) * right);
                break;
            }
            at += corner * (ahead + right);
            s -= arc;
            yaw -= 0.5f * kPi;
        }
        points_.push_back(at);
    }
}

float Lane::length() const { return spacing_ * static_cast<float>(points_.size()); }

Vector2f Lane::at(double turns) const {
    const double count = static_cast<double>(points_.size()), x = (turns - std::floor(turns)) * count;
    const auto i = static_cast<std::size_t>(x) % points_.size();
    const auto part = static_cast<float>(x - std::floor(x));
    return (1 - part) * points_[i] + part * points_[(i + 1) % points_.size()];
}

Vector2f Lane::heading(double turns) const {
    const double reach = 0.5 * static_cast<double>(kSmoothHeading / length());
    return (at(turns + reach) - at(turns - reach)).normalized();
}

}  // namespace posefusion::synth
