#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "hosts/mesh/mesh.hpp"

namespace posefusion {

/// A part of a mesh that is flat enough to be seen from one side without covering itself.
struct Chart {
    std::vector<std::uint32_t> faces;
    Eigen::Matrix<float, 2, 3> axes;  ///< rows: unit vectors of the plane it is projected to
    Eigen::Vector2f corner{0, 0};     ///< least coordinates in the plane, metres
    Eigen::Vector2f size{0, 0};       ///< metres

    /// In the rectangle of the chart, metres.
    [[nodiscard]] Eigen::Vector2f place_of(const Eigen::Vector3f& point) const { return axes * point - corner; }
};

/// Cuts the mesh into charts: each grows from a triangle to its neighbours while they face the mean direction of the
/// surface there within 50 degrees, do not come to lie over others, and the chart is not too wide. Every triangle is in
/// one chart.
/// @param texel   metres; overlaps are looked for at this resolution
/// @param widest  side of a chart, metres
[[nodiscard]] std::vector<Chart> cut_into_charts(const Mesh& mesh, float texel, float widest);

}  // namespace posefusion
