#pragma once
#include "hosts/report/report.hpp"

namespace posefusion {

/// Loops and relocalisations, drawn over the faded map seen from above, with a legend below.
struct LoopPicture {
    ColorImage image;
    Intrinsics camera;  ///< of the picture above the legend
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
};

/// Colours of the overlay. Nodes and edges of the graph are coloured by how far the loop has moved them.
struct LoopColors {
    Rgb8 trajectory{20, 110, 180}, lost{225, 87, 20}, keyframe{20, 20, 20}, loop{200, 20, 130},
        relocalised{30, 150, 60};
};
inline constexpr LoopColors kLoopColors;

/// The map, the trajectory, keyframes, the ends of closed loops joined, and the deformation graph of the last one.
/// @param upright  upright_axes()
[[nodiscard]] LoopPicture loop_picture(const ReportData& data, const Eigen::Isometry3d& upright);

/// Colour of a node that was moved by `share` (0 .. 1) of the largest displacement.
[[nodiscard]] Rgb8 displacement_color(double share);

}  // namespace posefusion
