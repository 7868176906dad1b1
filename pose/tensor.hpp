#pragma once
#include <cstddef>
#include <vector>

namespace posefusion {

/// A float tensor that owns its values, row-major. Networks of this project take and give [1, channels, height, width].
struct Tensor {
    std::vector<int> shape;
    std::vector<float> values;

    Tensor() = default;
    Tensor(int channels, int height, int width)
        : shape{1, channels, height, width},
          values(static_cast<std::size_t>(channels) * static_cast<std::size_t>(height) *
                 static_cast<std::size_t>(width)) {}

    [[nodiscard]] bool is_map_stack() const { return shape.size() == 4 && shape[0] == 1; }
    [[nodiscard]] int channels() const { return shape.at(1); }
    [[nodiscard]] int height() const { return shape.at(2); }
    [[nodiscard]] int width() const { return shape.at(3); }

    /// First value of a channel's height x width plane.
    [[nodiscard]] float* plane(int channel) { return values.data() + plane_offset(channel); }
    [[nodiscard]] const float* plane(int channel) const { return values.data() + plane_offset(channel); }
    [[nodiscard]] float& at(int channel, int y, int x) { return plane(channel)[y * width() + x]; }
    [[nodiscard]] float at(int channel, int y, int x) const { return plane(channel)[y * width() + x]; }

private:
    [[nodiscard]] std::size_t plane_offset(int channel) const {
        return static_cast<std::size_t>(channel) * static_cast<std::size_t>(height()) *
               static_cast<std::size_t>(width());
    }
};

}  // namespace posefusion
