#include "hosts/texture/baking.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "hosts/texture/seen_in_view.hpp"
#include "hosts/texture/triangle_raster.hpp"

namespace posefusion {
namespace {

constexpr float kOne = 256;  // weight 1 in whole numbers: 255 x 256 is the largest sum that 16 bits hold
constexpr float kFullByte = 255;

float weight_of(const std::vector<ViewWeight>& weights, std::uint32_t view) {
    for (const ViewWeight& w : weights)
        if (w.view == view) return w.weight;
    return 0;
}

/// Repeats the outermost texels outwards, a texel at a time.
void fill_gutters(ColorImage& texture, Image<std::uint8_t>& filled) {
    const int width = texture.width(), height = texture.height();
    for (int pass = 1; pass <= kGutter; ++pass) {
        const auto before = static_cast<std::uint8_t>(pass);  // filled in an earlier pass: 1 .. pass
        for (int v = 0; v < height; ++v) {
            for (int u = 0; u < width; ++u) {
                if (filled(u, v) != 0) continue;
                int r = 0, g = 0, b = 0, count = 0;
                for (const auto& [x, y] : {std::pair(u - 1, v), {u + 1, v}, {u, v - 1}, {u, v + 1}}) {
                    if (!texture.contains(x, y) || filled(x, y) == 0 || filled(x, y) > before) continue;
                    const Rgb8 c = texture(x, y);
                    r += c.r, g += c.g, b += c.b, ++count;
                }
                if (count == 0) continue;
                const auto mean = [&](int sum) { return static_cast<std::uint8_t>((sum + count / 2) / count); };
                texture(u, v) = {mean(r), mean(g), mean(b)};
                filled(u, v) = static_cast<std::uint8_t>(before + 1);
            }
        }
    }
}

}  // namespace

Baking::Baking(const Mesh& mesh, const std::vector<Chart>& charts, const AtlasLayout& layout,
               const std::vector<std::vector<ViewWeight>>& weights)
    : mesh_(mesh), charts_(charts), layout_(layout), weights_(weights), texels_(layout.size, layout.size) {}

template <class Visit>
void Baking::for_each_texel(std::size_t chart, std::uint32_t face, Visit&& visit) const {
    Triangle2 triangle;
    for (std::size_t k = 0; k < 3; ++k)
        triangle[k] = layout_.texel_of(charts_[chart], chart, mesh_.vertices[mesh_.faces[face][k]].position);
    bool any = false;
    rasterise(triangle, layout_.size, layout_.size, [&](int u, int v, const Eigen::Vector3f& inside) {
        any = true;
        visit(u, v, inside);
    });
    if (any) return;  // else it is smaller than a texel, and has that one in which it is
    const Eigen::Vector2f centre = (triangle[0] + triangle[1] + triangle[2]) / 3;
    visit(static_cast<int>(std::lround(centre.x())), static_cast<int>(std::lround(centre.y())),
          Eigen::Vector3f::Constant(1.0f / 3));
}

void Baking::add(std::uint32_t number, const View& view, const Intrinsics& camera, const Eigen::Vector3f& gain) {
    const SeenInView seen(mesh_, view, camera);
    for (std::size_t chart = 0; chart < charts_.size(); ++chart) {
        for (const std::uint32_t face : charts_[chart].faces) {
            const auto& corners = mesh_.faces[face];
            Eigen::Vector3f weights;
            for (std::size_t k = 0; k < 3; ++k)
                weights[static_cast<Eigen::Index>(k)] = weight_of(weights_[corners[k]], number);
            if (weights.isZero()) continue;
            Eigen::Matrix3f positions;
            for (std::size_t k = 0; k < 3; ++k)
                positions.col(static_cast<Eigen::Index>(k)) = mesh_.vertices[corners[k]].position;
            for_each_texel(chart, face, [&](int u, int v, const Eigen::Vector3f& inside) {
                const auto weight = std::floor(kOne * weights.dot(inside));
                if (!(weight > 0)) return;
                const auto pixel = seen.pixel_of(positions * inside);
                if (!pixel) return;
                const Eigen::Vector3f color = weight * seen.color_at(*pixel).cwiseProduct(gain).cwiseMin(kFullByte);
                Texel& texel = texels_(u, v);
                if (static_cast<float>(texel.weight) + weight > kOne) return;  // of a triangle that is smaller than it
                const auto add_to = [](std::uint16_t& sum, float value) {
                    sum = static_cast<std::uint16_t>(std::min(sum + std::lround(value), 65'535l));
                };
                add_to(texel.r, color.x());
                add_to(texel.g, color.y());
                add_to(texel.b, color.z());
                add_to(texel.weight, weight);
            });
        }
    }
}

ColorImage Baking::finish() const {
    ColorImage texture(layout_.size, layout_.size);
    Image<std::uint8_t> filled(layout_.size, layout_.size);
    for (std::size_t chart = 0; chart < charts_.size(); ++chart) {
        for (const std::uint32_t face : charts_[chart].faces) {
            Eigen::Matrix3f colors;  // of the vertices
            Eigen::Vector3f unseen;  // corners that no view shows keep their own
            for (std::size_t k = 0; k < 3; ++k) {
                const std::uint32_t corner = mesh_.faces[face][k];
                const Rgb8 c = mesh_.vertices[corner].color;
                colors.col(static_cast<Eigen::Index>(k)) = Eigen::Vector3f(c.r, c.g, c.b);
                unseen[static_cast<Eigen::Index>(k)] = weights_[corner].empty() ? 1 : 0;
            }
            for_each_texel(chart, face, [&](int u, int v, const Eigen::Vector3f& inside) {
                const Texel& texel = texels_(u, v);
                float own = kOne * unseen.dot(inside);
                if (texel.weight == 0) own = kOne;
                const Eigen::Vector3f seen(texel.r, texel.g, texel.b);
                const Eigen::Vector3f color = (seen + own * (colors * inside)) / (own + texel.weight);
                const auto byte = [](float value) {
                    return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0f, kFullByte)));
                };
                texture(u, v) = {byte(color.x()), byte(color.y()), byte(color.z())};
                filled(u, v) = 1;
            });
        }
    }
    fill_gutters(texture, filled);
    return texture;
}

}  // namespace posefusion
