#pragma once
#include <vector>

#include "segmentation/node_grid.hpp"

namespace posefusion {

/// Over-segmentation of the grid into smooth or convex pieces of surface: a thing is separated from what it stands on
/// by a concave crease, and from what lies behind it by a step in depth (locally convex connected patches, Stein et
/// al., CVPR 2014).
struct ConvexPatches {
    std::vector<int> patch;  ///< per node; -1 = no depth, or no surface that is known
    int count = 0;
    /// Of the faces of which the patches consist: regions that are smooth, between edges of any kind.
    std::vector<int> face;  ///< as patch
    int face_count = 0;
};

[[nodiscard]] ConvexPatches find_convex_patches(const NodeGrid& grid);

}  // namespace posefusion
