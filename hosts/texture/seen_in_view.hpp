#pragma once
#include <Eigen/Geometry>
#include <optional>

#include "engine/core/intrinsics.hpp"
#include "hosts/export/view.hpp"
#include "hosts/mesh/mesh.hpp"

namespace posefusion {

/// Which points of a mesh a view shows.
class SeenInView {
public:
    /// @param view  must outlive this
    SeenInView(const Mesh& mesh, const View& view, const Intrinsics& camera);

    /// Where a point of the mesh is seen (whole numbers are centres of pixels). nullopt: outside of the image, behind
    /// another part of the mesh, where people or movers are, or where the depth image has something else.
    [[nodiscard]] std::optional<Eigen::Vector2f> pixel_of(const Eigen::Vector3f& point) const;

    /// How many pixels show a square metre of the surface, less towards the border of the image, where lenses are worse
    /// and dark; 0: the surface is not seen, or from behind, or too flat.
    [[nodiscard]] float quality(const Eigen::Vector3f& point, const Eigen::Vector3f& normal) const;

    /// Between the pixels, linearly; 0 .. 255. @param pixel  in the image
    [[nodiscard]] Eigen::Vector3f color_at(const Eigen::Vector2f& pixel) const;

private:
    const View& view_;
    Intrinsics camera_;
    Eigen::Isometry3f T_camera_world_;
    DepthImage nearest_;  ///< of the mesh in the 3 x 3 pixels around; 0 = none
};

}  // namespace posefusion
