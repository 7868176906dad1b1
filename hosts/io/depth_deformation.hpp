#pragma once
#include <array>
#include <cstddef>

#include "engine/core/image.hpp"

namespace posefusion {

/// The systematic error of a depth sensor that measures disparity, as cameras with a pattern projector and stereo do:
/// 1 / z = 1 / measured + c(x, y), where c is known at the nodes of a coarse grid over the image and linear between
/// them in x and in y. After BAD SLAM (Schoeps, Sattler & Pollefeys 2019), without the factor exp(-a z) that their c
/// has: with it the shape of the error over z is another unknown, which short recordings say nothing about.
struct DepthDeformation {
    static constexpr int kColumns = 5, kRows = 4;
    static constexpr std::size_t kNodes = kColumns * kRows;

    std::array<float, kNodes> nodes{};  ///< c in 1/m, row by row; the corner nodes are at the corners of the image

    [[nodiscard]] bool is_none() const { return nodes == std::array<float, kNodes>{}; }
    friend bool operator==(const DepthDeformation&, const DepthDeformation&) = default;
};

/// The nodes round a position in an image and their shares in c there.
struct DeformationCell {
    std::array<std::size_t, 4> nodes{};
    std::array<double, 4> weights{};
};
[[nodiscard]] DeformationCell deformation_cell(double u, double v, int width, int height);

/// c of every pixel, 1/m; empty where there is no deformation.
[[nodiscard]] Image<float> deformation_map(const DepthDeformation& deformation, int width, int height);

/// Undoes the deformation. Pixels without depth stay so; those that would be at no finite distance lose theirs.
/// @param map  of the size of `depth`, or empty
void undo_deformation(const Image<float>& map, DepthImage& depth);

}  // namespace posefusion
