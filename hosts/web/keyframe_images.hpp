#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "engine/core/image.hpp"
#include "hosts/io/trajectory.hpp"
#include "hosts/web/scene.hpp"

namespace posefusion {

/// A picture for the corner of a page: at most 320 pixels wide.
[[nodiscard]] ColorImage small_picture(const ColorImage& image);
/// A JPEG of it, 15 kB.
[[nodiscard]] std::string jpeg_of(const ColorImage& picture);

/// Fills in the images of the keyframes, undistorted, from the recording of the run: at most 320 pixels wide, of at
/// most 60 keyframes spread over the run.
/// @param scene      of the run; its poses are those of the trajectory
/// @param folder     of the run
/// @param recording  where it is now; empty = where it was
/// @param cancelled  asked before each image
/// @return why there are none; empty: there are
std::string add_keyframe_images(WebScene& scene, const std::filesystem::path& folder,
                                const std::filesystem::path& recording, const std::function<bool()>& cancelled);

}  // namespace posefusion
