#pragma once
#include <Eigen/Geometry>
#include <cstdint>
#include <vector>

#include "engine/core/depth_noise.hpp"
#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"

/// Did these points move like this? The same question is asked of every hypothesis: that a thing moved as it was
/// tracked, that it moved with another one, that it stood still.
namespace posefusion {

/// The depth of a frame at every `step`-th pixel.
struct DepthGrid {
    Intrinsics camera;  ///< of the grid: cells project to whole numbers
    int step = 1;       ///< pixels
    DepthNoise noise;
    std::vector<float> depth;  ///< metres; 0 = unknown

    [[nodiscard]] std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(camera.width) + static_cast<std::size_t>(x);
    }
    [[nodiscard]] bool contains(int x, int y) const {
        return x >= 0 && y >= 0 && x < camera.width && y < camera.height;
    }
    struct Position {
        int x, y;
    };
    [[nodiscard]] Position position(std::size_t cell) const {
        const auto width = static_cast<std::size_t>(camera.width);
        return {static_cast<int>(cell % width), static_cast<int>(cell / width)};
    }
    /// The eight neighbours of a cell that has depth, whose depth differs from its by less than `most_apart` metres.
    [[nodiscard]] std::vector<std::size_t> connected(std::size_t cell, float most_apart) const;
    [[nodiscard]] Eigen::Vector3f point(int x, int y) const;
};

/// About 160 cells across. @param unusable  non-zero: pixels whose depth says nothing (people); empty = none
[[nodiscard]] DepthGrid make_depth_grid(const DepthImage& depth, const LabelImage& unusable, const Intrinsics& camera,
                                        const DepthNoise& noise);

/// Depths that differ by less than the first are of one surface, by more than the second of two; metres.
/// @param sigma  standard deviation of the depth noise
[[nodiscard]] constexpr float same_depth(float sigma) { return 0.012f + 2 * sigma; }
[[nodiscard]] constexpr float other_depth(float sigma) { return 0.03f + 4 * sigma; }

/// Of points that a motion takes somewhere: what is measured there.
struct Agreement {
    int fits = 0;     ///< a surface at their depth
    int through = 0;  ///< only what is behind them: they cannot be there
    int hidden = 0;   ///< something in front of them
    [[nodiscard]] int seen() const { return fits + through; }
    [[nodiscard]] float violated() const {
        return seen() == 0 ? 0.0f : static_cast<float>(through) / static_cast<float>(seen());
    }
};

/// @param points  camera coordinates at an earlier time;  @param T_now_then  where the motion takes them
/// A position may be off by a cell: the points are samples, and their normals are not known.
[[nodiscard]] Agreement agreement(const std::vector<Eigen::Vector3f>& points, const Eigen::Isometry3d& T_now_then,
                                  const DepthGrid& now);

/// Mean distance between where two motions take the points, metres.
[[nodiscard]] double distance_between(const std::vector<Eigen::Vector3f>& points, const Eigen::Isometry3d& a,
                                      const Eigen::Isometry3d& b);

}  // namespace posefusion
