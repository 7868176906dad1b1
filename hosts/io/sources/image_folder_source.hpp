#pragma once
#include "hosts/io/frame_source.hpp"

namespace posefusion {

/// A folder of colour and depth images without lists. Colour images are those in a subfolder rgb, color, colour, image
/// or images, or with one of the first three words in their name; depth images those in a subfolder depth, or with that
/// word in their name (7-Scenes: frame-000012.color.png, frame-000012.depth.png). Others are ignored.
///
/// They are paired by the last number in their names. Numbers with a decimal point are time stamps in seconds, and
/// are paired within 20 ms; other numbers count frames at 30 Hz. Camera and ground truth as for TUM folders.
[[nodiscard]] std::unique_ptr<FrameSource> open_image_folder(const std::filesystem::path& folder,
                                                             const SourceOptions& options);

}  // namespace posefusion
