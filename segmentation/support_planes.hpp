#pragma once
#include <Eigen/Core>
#include <vector>

#include "segmentation/node_grid.hpp"

/// Horizontal surfaces that carry people and things: floor, table tops, seats. Where feet and hands touch them there is
/// no step in depth, so they are recognised by being horizontal planes.
namespace posefusion {

struct Plane {
    Eigen::Vector3f normal;  ///< unit, upwards
    float offset = 0;        ///< normal . point = offset for points of the plane, metres
    [[nodiscard]] float height(const Eigen::Vector3f& point) const { return normal.dot(point) - offset; }
};

struct SupportConfig {
    float max_tilt =
        50;  ///< angle between the image's up and the true up, degrees: how far the camera may roll or pitch
    float normal_spread = 15;  ///< scatter of normals on one plane, degrees
    float bin = 0.03f;         ///< of the histogram of heights, metres
    float min_area = 0.15f;    ///< smaller surfaces are not trusted to be planes, square metres
    int max_planes = 4;
    float thickness = 0.025f;  ///< points this near belong to the plane, metres, beyond noise
};

/// Finds the largest horizontal planes among the nodes where free[i] is set (those away from people).
[[nodiscard]] std::vector<Plane> find_support_planes(const NodeGrid& grid, const std::vector<bool>& free,
                                                     const SupportConfig& config);

/// Whether a node is part of one of the planes.
[[nodiscard]] bool on_support(const Node& node, const std::vector<Plane>& planes, const DepthNoise& noise,
                              const SupportConfig& config);

}  // namespace posefusion
