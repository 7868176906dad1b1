#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace posefusion {

/// What a view shows of a place; channels 0 .. 255.
struct ColorSample {
    std::uint32_t place = 0, view = 0;
    Eigen::Vector3f color = Eigen::Vector3f::Zero();
};

/// Automatic exposure and white balance change from image to image: factors for the channels of each view, with which
/// all views agree as well as possible on the places that several of them show, and with the colours of the map. Least
/// squares of the logarithms; samples that stay far from what others say (reflections, edges) are then left out once.
/// Clipped and nearly black values say nothing.
/// @param map  colour of each place in the map  @return factor per channel of each view; 1 for one without samples
[[nodiscard]] std::vector<Eigen::Vector3f> level_exposure(const std::vector<ColorSample>& samples,
                                                          const std::vector<Eigen::Vector3f>& map, std::size_t views);

}  // namespace posefusion
