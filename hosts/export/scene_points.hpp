#pragma once
#include <cstdint>
#include <vector>

#include "engine/map/surfel.hpp"
#include "hosts/export/view.hpp"

/// Points of the map for programs that begin with a sparse cloud.
namespace posefusion {

/// At most `most` of the surfels, evenly spread over the surfaces, whatever the distance that they were seen from: of
/// each cell of a grid the most confident one. Their order stays. Surfels that are not finite are left out.
[[nodiscard]] std::vector<Surfel> evenly_spread(const std::vector<Surfel>& surfels, std::size_t most);

/// A point that is seen in a view.
struct PointInView {
    std::uint32_t point = 0;  ///< position in the list of points
    Eigen::Vector2f pixel;    ///< whole numbers are centres of pixels
};

/// The points that a view shows: within its image, facing it, where no people are, and at the depth that was measured
/// there; where nothing was measured it is not known what is seen.
[[nodiscard]] std::vector<PointInView> points_in_view(const std::vector<Surfel>& points, const View& view,
                                                      const Camera& camera);

}  // namespace posefusion
