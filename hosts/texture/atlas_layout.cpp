#include "hosts/texture/atlas_layout.hpp"

#define STB_RECT_PACK_IMPLEMENTATION
#define STBRP_STATIC
#include <stb/stb_rect_pack.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.hpp"

namespace posefusion {
namespace {

constexpr int kLeast = 256;
constexpr float kCoarser = 1.1f;    // per attempt
constexpr float kCoarsest = 1'000;  // times the texel that is useful; nothing would be seen any more

/// @return whether all have a place
bool pack(const std::vector<Chart>& charts, AtlasLayout& layout) {
    std::vector<stbrp_rect> rectangles;
    for (std::size_t i = 0; i < charts.size(); ++i) {
        const auto side = [&](float metres) {
            return static_cast<int>(std::ceil(metres / layout.texel)) + 1 + 2 * kGutter;
        };
        const int width = side(charts[i].size.x()), height = side(charts[i].size.y());
        if (width > layout.size || height > layout.size) return false;
        rectangles.push_back({static_cast<int>(i), width, height, 0, 0, 0});
    }
    std::vector<stbrp_node> nodes(static_cast<std::size_t>(layout.size));
    stbrp_context context;
    stbrp_init_target(&context, layout.size, layout.size, nodes.data(), layout.size);
    if (stbrp_pack_rects(&context, rectangles.data(), static_cast<int>(rectangles.size())) == 0) return false;
    layout.corners.resize(charts.size());
    for (const stbrp_rect& r : rectangles)
        layout.corners[static_cast<std::size_t>(r.id)] =
            Eigen::Vector2f(static_cast<float>(r.x + kGutter), static_cast<float>(r.y + kGutter));
    return true;
}

}  // namespace

AtlasLayout lay_out(const std::vector<Chart>& charts, float texel, int most) {
    AtlasLayout layout;
    layout.texel = texel;
    for (layout.size = std::min(kLeast, most); layout.size < most; layout.size = std::min(2 * layout.size, most))
        if (pack(charts, layout)) return layout;
    while (!pack(charts, layout)) {
        layout.texel *= kCoarser;
        if (layout.texel > kCoarsest * texel)
            throw Error("the parts of the surface do not fit into a texture of " + std::to_string(most) +
                        " pixels; give a larger --texture-size");
    }
    return layout;
}

}  // namespace posefusion
