#pragma once
#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "engine/core/image.hpp"

namespace posefusion {

/// Intensities (0..255) of an image and of its halves.
using IntensityPyramid = std::vector<Image<float>>;
[[nodiscard]] IntensityPyramid intensity_pyramid(const ColorImage& color);

struct PatchConfig {
    static constexpr int kLevels = 3;                 ///< of the pyramid, the image itself included
    static constexpr int kReach = 6;                  ///< pixels of each level from the centre of a patch to its border
    static constexpr int kSteps = 15;                 ///< on each level
    static constexpr double kConverged = 2e-3;        ///< pixels
    static constexpr double kLeastCorrelation = 0.9;  ///< of the intensities of the same patch in two images
    static constexpr double kMostShift = 12;          ///< pixels, from where it is expected
};

/// A small piece of a plane, as an image shows it.
struct SurfacePatch {
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< its centre
    double inverse_depth = 0;                         ///< there, 1/m
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< change of the inverse depth per pixel
};

struct FoundPatch {
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
    double sigma = 0;  ///< standard deviation of its position where it is least certain, pixels
};

using PlaceThere = std::function<std::optional<Eigen::Vector2d>(const Eigen::Vector2d& pixel, double inverse_depth)>;

/// Finds a patch of one image in another, to a fraction of a pixel: the patch as it would be seen there is shifted, and
/// made brighter or darker and richer or poorer in contrast, until it looks as the other image does (Lucas & Kanade
/// 1981; Gauss-Newton from coarse to fine). nullopt: it does not look alike, or is out of view.
/// @param seen_there  where the other image shows what this one shows at a pixel with an inverse depth (1/m), as far as
/// the motion between the cameras is known; nullopt: nowhere
[[nodiscard]] std::optional<FoundPatch> find_patch(const IntensityPyramid& here, const SurfacePatch& patch,
                                                   const IntensityPyramid& there, const PlaceThere& seen_there);

}  // namespace posefusion
