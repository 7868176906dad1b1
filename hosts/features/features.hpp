#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "hosts/features/feature_config.hpp"

namespace posefusion {

/// A point of the static scene, of known depth, that can be recognised in other images.
struct Feature {
    Eigen::Vector2f pixel = Eigen::Vector2f::Zero();  ///< pixels of the whole image
    float sigma = 0;                                  ///< standard deviation of its position, pixels
    float depth = 0;                                  ///< metres
    std::array<std::uint8_t, 32> descriptor{};        ///< ORB (Rublee et al. 2011): 256 comparisons of intensities
};
using Features = std::vector<Feature>;

/// Finds ORB features, spread over the image; none on people, none without depth or at its edges.
/// @param labels  0 static; empty: all is static  Returns at most config.count, in a fixed order.
[[nodiscard]] Features find_features(const ColorImage& color, const DepthImage& depth, const LabelImage& labels,
                                     const FeatureConfig& config);

/// Two features that look like the same point: indices.
struct FeatureMatch {
    std::uint32_t earlier = 0, current = 0;
};

/// Pairs of features that are each other's nearest by descriptor, and clearly so; ascending in `current`.
[[nodiscard]] std::vector<FeatureMatch> match_features(const Features& earlier, const Features& current);

}  // namespace posefusion
