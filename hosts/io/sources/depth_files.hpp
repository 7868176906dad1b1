#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "hosts/io/depth_registration.hpp"
#include "hosts/io/sources/folder_camera.hpp"

/// The depth images of a folder, whatever they count and whoever took them.
namespace posefusion {

class DepthFiles {
public:
    /// Looks at the first images that can be read.
    /// @param camera  of the folder; gets the depth_scale of what read() gives
    /// @param folder  for messages. `warnings` gets what was assumed.
    /// Throws Error where the images and the camera do not fit.
    DepthFiles(CameraDescription& camera, DepthCoding coding, const std::vector<std::filesystem::path>& files,
               const std::string& folder, std::vector<std::string>& warnings);

    /// Of the size of colour, registered to it. May be called from several threads. Throws Error naming the file.
    [[nodiscard]] RawDepth read(const std::filesystem::path& file) const;

private:
    ImageSize size_;         ///< of the files
    float float_metre_ = 1;  ///< value of one metre in float images; one, unless the camera file says another
    bool rotated_ = false;   ///< see DepthCoding::MaybeRotated
    float depth_scale_;
    std::optional<DepthRegistration> registration_;
};

}  // namespace posefusion
