#pragma once
#include <optional>
#include <string>
#include <vector>

#include "hosts/io/camera_file.hpp"
#include "hosts/io/image_file.hpp"

/// Registers depth images of another camera, or of another size, to the colour camera.
namespace posefusion {

/// The depth image is treated as a surface: four neighbours at about the same distance form two triangles, which are
/// rendered into the colour image with a depth test. A measurement without such neighbours (at an edge, or isolated)
/// covers the area of its own pixel. So small depth images give closed surfaces in large colour images, and foreground
/// and background are never connected.
class DepthRegistration {
public:
    /// @param color  camera of the resulting images; its lens is that of the colour images, which are undistorted later
    DepthRegistration(const DepthCamera& depth, const Camera& color);

    /// @param depth  of the size of the depth camera  @param depth_scale  value of one metre, in input and output
    /// Thread-safe.
    [[nodiscard]] RawDepth apply(const RawDepth& depth, float depth_scale) const;

    [[nodiscard]] ImageSize depth_size() const { return {rays_.width(), rays_.height()}; }

private:
    Camera color_;
    Eigen::Isometry3f T_color_depth_;
    Image<PlanePoint> rays_;           ///< rays of the depth camera's pixels: intersections with the plane z = 1
    float footprint_u_, footprint_v_;  ///< half a depth pixel in pixels of colour, at the same distance
};

/// The registration that depth images need, or nullopt if they are registered already.
/// @param depth  size of the depth images, nullopt where unknown
/// @param name  of the recording, for messages. Assumptions are added to `warnings`.
/// Without a depth camera in the description, depth images of another size but the same aspect ratio are assumed to be
/// of the same camera. Throws Error: another aspect ratio, or a description that does not match the images.
[[nodiscard]] std::optional<DepthRegistration> registration_for(const CameraDescription& description,
                                                                std::optional<ImageSize> depth, const std::string& name,
                                                                std::vector<std::string>& warnings);

}  // namespace posefusion
