#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "engine/slam/slam.hpp"

/// Duplicate surfaces in a map: a camera that returns with a drifted pose and does not close the loop creates a second
/// wall a few centimetres in front of or behind the first.
namespace posefusion {

/// A surfel has a second layer if there are `support` other surfels each of which
///  - lies min_offset to max_offset in front of or behind it along its normal,
///  - is off the line along that normal by at most lateral_radius, and
///  - faces the same way, up to max_angle (the back of a board does not count).
/// On one continuous surface a neighbour that faces the same way up to a is off the tangent plane by at most
/// lateral_radius * tan(a); so lateral_radius <= min_offset / tan(max_angle) ensures that a surface is not its own
/// second layer. Objects that do have layers (books in a shelf, curtains) count as well: compare with the same room
/// without drift.
struct DuplicateSurfaceConfig {
    float min_offset = 0.02f;       ///< metres
    float max_offset = 0.10f;       ///< metres
    float lateral_radius = 0.02f;   ///< metres
    float max_angle = 45;           ///< degrees, below 90
    int support = 2;                ///< surfels, so that a single stray one is not a layer
    std::uint32_t visit_gap = 100;  ///< layers created this many frames apart stem from different visits
};

struct DuplicateSurface {
    std::size_t surfels = 0;     ///< examined
    std::size_t duplicated = 0;  ///< of these, with a second layer
    std::size_t revisited = 0;   ///< of these, with a second layer of surfels from another visit: rarely furniture
    [[nodiscard]] double fraction() const { return share(duplicated); }
    [[nodiscard]] double revisited_fraction() const { return share(revisited); }

private:
    [[nodiscard]] double share(std::size_t count) const {
        return surfels == 0 ? 0 : static_cast<double>(count) / static_cast<double>(surfels);
    }
};

/// @param map            stable surfels
/// @param is_duplicated  if not null, gets a flag per surfel
/// Throws Error when the configuration is invalid.
[[nodiscard]] DuplicateSurface find_duplicate_surface(const std::vector<Surfel>& map,
                                                      const DuplicateSurfaceConfig& config = {},
                                                      std::vector<std::uint8_t>* is_duplicated = nullptr);

}  // namespace posefusion
