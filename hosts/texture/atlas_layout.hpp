#pragma once
#include <Eigen/Core>
#include <vector>

#include "hosts/texture/charts.hpp"

namespace posefusion {

/// Texels around each chart that repeat its border, for filters that look beyond it.
inline constexpr int kGutter = 4;

/// Where the charts are in the texture.
struct AtlasLayout {
    int size = 0;                          ///< of the square texture, texels; a power of two, or the largest allowed
    float texel = 0;                       ///< metres
    std::vector<Eigen::Vector2f> corners;  ///< of each chart, texels (whole numbers are centres)

    /// Of a point of a chart, in the texture.
    [[nodiscard]] Eigen::Vector2f texel_of(const Chart& chart, std::size_t number, const Eigen::Vector3f& point) const {
        return corners[number] + chart.place_of(point) / texel;
    }
};

/// The smallest texture in which the charts have their place, side by side (stb_rect_pack's skylines); where that is
/// larger than `most`, texels become larger instead. Throws Error: there are too many charts.
/// @param texel  metres, as small as is useful  @param most  texels per side
[[nodiscard]] AtlasLayout lay_out(const std::vector<Chart>& charts, float texel, int most);

}  // namespace posefusion
