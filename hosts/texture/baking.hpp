#pragma once
#include <Eigen/Core>
#include <functional>
#include <vector>

#include "hosts/mesh/mesh.hpp"
#include "hosts/texture/atlas_layout.hpp"
#include "hosts/texture/texture_views.hpp"
#include "hosts/texture/view_choice.hpp"

namespace posefusion {

/// A texture that is being put together, one view after the other. Takes 11 bytes per texel.
class Baking {
public:
    /// All must outlive this. @param weights  of the views at each vertex, see choose_views()
    Baking(const Mesh& mesh, const std::vector<Chart>& charts, const AtlasLayout& layout,
           const std::vector<std::vector<ViewWeight>>& weights);

    /// Adds what the view shows, where it has a weight. @param gain  factor per channel
    void add(std::uint32_t number, const View& view, const Intrinsics& camera, const Eigen::Vector3f& gain);
    /// The texture. What no view showed has the colours of the vertices; the borders of charts go on into the gutter.
    [[nodiscard]] ColorImage finish() const;

private:
    struct Texel {  // sums of weight x 256 x channel, and of weight x 256
        std::uint16_t r = 0, g = 0, b = 0, weight = 0;
    };
    template <class Visit>
    void for_each_texel(std::size_t chart, std::uint32_t face, Visit&& visit) const;

    const Mesh& mesh_;
    const std::vector<Chart>& charts_;
    const AtlasLayout& layout_;
    const std::vector<std::vector<ViewWeight>>& weights_;
    Image<Texel> texels_;
};

}  // namespace posefusion
