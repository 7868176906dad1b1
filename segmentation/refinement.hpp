#pragma once
#include <cstdint>
#include <vector>

#include "engine/core/image.hpp"
#include "segmentation/node_grid.hpp"

/// From the labels of nodes to the labels of pixels.
namespace posefusion {

struct RefinementConfig {
    float depth_sigma = 0.03f;  ///< a pixel follows nodes whose depth is this near, metres, beyond noise; at the
                                ///< default SegmentationConfig::sigma, grows with it
    float color_sigma = 0.08f;  ///< and whose colour is this near, 0..1 per channel, root of the sum of squares
};

/// A pixel whose surrounding nodes have one label takes it; at borders the nine nodes around vote, weighted by how much
/// their depth, colour and position resemble the pixel's (a joint-bilateral vote). Pixels without depth go by colour.
[[nodiscard]] LabelImage refine_labels(const NodeGrid& grid, const std::vector<std::uint8_t>& labels,
                                       const ColorImage& color, const DepthImage& depth,
                                       const RefinementConfig& config);

}  // namespace posefusion
