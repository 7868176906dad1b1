#pragma once
#include <Eigen/Geometry>
#include <optional>
#include <string>

#include "engine/core/image.hpp"
#include "hosts/io/camera_file.hpp"

namespace posefusion {

/// Where nerfstudio and COLMAP have the centre of the first pixel; ours is 0.
inline constexpr float kPixelCentre = 0.5f;

/// A frame of a run as it is exported: images of one size and one camera, and where that was.
struct View {
    std::string name;  ///< of its files, without an extension: unique, and sorted by time
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    ColorImage color;
    DepthImage depth;   ///< 0 also where people or movers are
    LabelImage people;  ///< not 0: people and movers, with a margin; empty: not known
};

/// Where a camera sees a point. @param point  in its frame, metres
/// @return in pixels of the distorted image (whole numbers are centres of pixels); nullopt: outside of the image
[[nodiscard]] std::optional<Eigen::Vector2f> pixel_of(const Eigen::Vector3f& point, const Camera& camera);

/// What is not 0 in `labels`, and what is no farther from it than `margin` pixels in u and v, keeps or gets a label.
[[nodiscard]] LabelImage grown(const LabelImage& labels, int margin);

/// Programs that learn scenes want images of 1 where a pixel is to be used: 255 in static parts, 0 on people.
[[nodiscard]] LabelImage usable_pixels(const View& view);

}  // namespace posefusion
