#pragma once
#include <optional>
#include <string>
#include <vector>

#include "hosts/io/camera_file.hpp"
#include "hosts/io/image_file.hpp"

/// Depth images of another camera, or of another size, as the colour camera would have measured them.
namespace posefusion {

/// The depth image is taken for a surface: between four neighbours at about the same distance lie two triangles, which
/// are drawn into the colour image, the nearest surface winning. A measurement without such neighbours (at an edge, or
/// alone) covers the area of its own pixel. So images of few pixels give closed surfaces in large ones, and nothing is
/// put between foreground and background.
class DepthRegistration {
public:
    /// @param color  of the images that come out; its lens is that of the colour images, which are still to be undone
    DepthRegistration(const DepthCamera& depth, const Camera& color);

    /// @param depth  of the size of the depth camera. @param depth_scale  value of one metre, in and out
    /// May be called from several threads.
    [[nodiscard]] RawDepth apply(const RawDepth& depth, float depth_scale) const;

    [[nodiscard]] ImageSize depth_size() const { return {rays_.width(), rays_.height()}; }

private:
    Camera color_;
    Eigen::Isometry3f T_color_depth_;
    Image<PlanePoint> rays_;           ///< of the pixels of the depth camera: where they meet the plane z = 1
    float footprint_u_, footprint_v_;  ///< half a depth pixel in pixels of colour, at the same distance
};

/// What has to be done to depth images before they belong to colour: nothing (nullopt) or a registration.
/// @param color, depth  sizes of the images, nullopt where they could not be found out
/// @param name  of the recording, for messages. `warnings` gets what was assumed.
/// Without a depth camera in the description, depth images of another size but the same shape are taken to be of the
/// same camera. Throws Error: another shape, or a description that does not fit the images.
[[nodiscard]] std::optional<DepthRegistration> registration_for(const CameraDescription& description,
                                                                std::optional<ImageSize> depth, const std::string& name,
                                                                std::vector<std::string>& warnings);

}  // namespace posefusion
