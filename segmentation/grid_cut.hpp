#pragma once
#include <cstdint>
#include <vector>

#include "segmentation/node_grid.hpp"

/// Minimum cut on the node grid.
namespace posefusion {

/// The cost of different labels of two neighbouring nodes.
struct SmoothnessConfig {
    float weight = 1.0f;        ///< of an edge between equal neighbours, in units of the unary term
    float depth_sigma = 0.03f;  ///< depth step that lets the cut pass, metres, beyond what noise and slant explain; at
                                ///< the default SegmentationConfig::sigma, grows with it
    /// Colour difference that lets the cut pass, of 0..1 per channel, root of the sum of squares.
    float color_sigma = 0.10f;
    float color_floor = 0.35f;  ///< share of the weight that colour cannot take where depth says "same surface"
};

/// Labels each node 0 (static) or 1 (person) so that the energy is minimal: the unary term, the sum of preferences
/// overruled (preference[i] > 0 for person, < 0 for static), plus the smoothness term, eq. (2), along the borders.
[[nodiscard]] std::vector<std::uint8_t> cut_grid(const NodeGrid& grid, const std::vector<float>& preference,
                                                 const SmoothnessConfig& config);

}  // namespace posefusion
