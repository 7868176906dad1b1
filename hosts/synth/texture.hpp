#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "engine/core/image.hpp"
#include "hosts/synth/mesh.hpp"

namespace posefusion::synth {

/// A picture that tiles, with mip levels, stored in sRGB and sampled in linear light.
class Texture {
public:
    Texture() = default;
    /// @param span   metres that the picture covers in u and v
    /// @param paint  sRGB colour (0..1) at metres (u, v) in [0, span)
    Texture(const Vector2f& span, int pixels_per_metre, const std::function<Vector3f(float, float)>& paint,
            bool emits = false);

    /// Trilinear look-up. @param uv metres  @param footprint metres on the surface that one sample covers
    [[nodiscard]] Vector3f sample(const Vector2f& uv, float footprint) const;
    [[nodiscard]] bool emits() const { return emits_; }  ///< emissive, not lit

private:
    [[nodiscard]] Vector3f bilinear(const ColorImage& level, const Vector2f& uv) const;
    Vector2f span_ = Vector2f::Ones();
    float texel_ = 1;  ///< metres, finest level
    std::vector<ColorImage> levels_;
    bool emits_ = false;
};

/// Index of a texture in the catalogue of a room. Posters, pictures and cartons come in several designs.
enum Material : std::uint16_t {
    Plain,
    Plaster,
    Wallpaper,
    FloorBoards,
    Ceiling,
    Carpet,
    Wood,
    DarkWood,
    Fabric,
    Cardboard,
    BookSpine,
    Screen,
    Keyboard,
    WindowView,
    Curtain,
    Leaf,
    Soil,
    Metal,
    LampGlow,
    Paper,
    CeramicBand,
    Door,
    Poster0,
    Poster1,
    Poster2,
    Poster3,
    FreshPaint,
    Motley,  ///< patches of all colours
    Film,    ///< what a screen shows
    kMaterialCount,
};
inline constexpr int kPosterCount = 4;

/// All textures of a room, in the order of Material; colours and designs vary with the seed.
[[nodiscard]] std::vector<Texture> paint_textures(std::uint64_t seed, int threads);

}  // namespace posefusion::synth
