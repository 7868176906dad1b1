#pragma once
#include <cstdint>
#include <vector>

#include "segmentation/node_grid.hpp"

/// Minimum cut on the node grid.
namespace posefusion {

/// What two neighbouring nodes pay for different labels.
struct SmoothnessConfig {
    float weight = 1.0f;        ///< of an edge between equal neighbours, in units of the unary term
    float depth_sigma = 0.03f;  ///< depth step that lets the cut pass, metres, beyond what noise and slant explain
    float color_sigma =
        0.10f;  ///< colour difference that lets the cut pass, of 0..1 per channel, root of sum of squares
    float color_floor = 0.35f;  ///< share of the weight that colour cannot take where depth says "same surface"
};

/// Labels each node 0 (static) or 1 (person). preference[i] > 0 speaks for person, < 0 for static; the cut minimises
/// the preferences overruled plus the smoothness of eq. (2)'s kind along the borders.
[[nodiscard]] std::vector<std::uint8_t> cut_grid(const NodeGrid& grid, const std::vector<float>& preference,
                                                 const SmoothnessConfig& config);

}  // namespace posefusion
