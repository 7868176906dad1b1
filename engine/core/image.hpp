#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

/// Images that own their pixels, row-major without padding, index (u, v) = (column, row).
namespace posefusion {

template <class Pixel>
class Image {
public:
    Image() = default;
    Image(int width, int height, Pixel fill = {})
        : width_(width),
          height_(height),
          pixels_(static_cast<std::size_t>(width) * static_cast<std::size_t>(height), fill) {}

    [[nodiscard]] int width() const { return width_; }
    [[nodiscard]] int height() const { return height_; }
    [[nodiscard]] bool empty() const { return pixels_.empty(); }
    [[nodiscard]] std::size_t size() const { return pixels_.size(); }
    [[nodiscard]] bool contains(int u, int v) const { return u >= 0 && v >= 0 && u < width_ && v < height_; }

    [[nodiscard]] Pixel& operator()(int u, int v) { return pixels_[index(u, v)]; }
    [[nodiscard]] const Pixel& operator()(int u, int v) const { return pixels_[index(u, v)]; }
    [[nodiscard]] Pixel& operator[](std::size_t i) { return pixels_[i]; }
    [[nodiscard]] const Pixel& operator[](std::size_t i) const { return pixels_[i]; }
    [[nodiscard]] Pixel* data() { return pixels_.data(); }
    [[nodiscard]] const Pixel* data() const { return pixels_.data(); }
    [[nodiscard]] auto begin() { return pixels_.begin(); }
    [[nodiscard]] auto end() { return pixels_.end(); }
    [[nodiscard]] auto begin() const { return pixels_.begin(); }
    [[nodiscard]] auto end() const { return pixels_.end(); }

private:
    [[nodiscard]] std::size_t index(int u, int v) const {
        return static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(u);
    }
    int width_ = 0, height_ = 0;
    std::vector<Pixel> pixels_;
};

struct Rgb8 {
    std::uint8_t r = 0, g = 0, b = 0;
    friend bool operator==(const Rgb8&, const Rgb8&) = default;
};

/// A colour in one word, as the shaders store it: r | g << 8 | b << 16 (GLSL: packUnorm4x8).
[[nodiscard]] constexpr std::uint32_t pack_rgb(Rgb8 c) {
    return std::uint32_t{c.r} | std::uint32_t{c.g} << 8 | std::uint32_t{c.b} << 16;
}
/// The colour in the lower 24 bits; the upper eight are ignored.
[[nodiscard]] constexpr Rgb8 unpack_rgb(std::uint32_t word) {
    return {static_cast<std::uint8_t>(word), static_cast<std::uint8_t>(word >> 8),
            static_cast<std::uint8_t>(word >> 16)};
}

using ColorImage = Image<Rgb8>;          ///< sRGB, channel order R, G, B
using DepthImage = Image<float>;         ///< z along the optical axis in metres; 0 = no measurement
using LabelImage = Image<std::uint8_t>;  ///< 0 = static scene, 1..n = person

}  // namespace posefusion
