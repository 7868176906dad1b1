#include "hosts/io/sources/folder.hpp"

#include <utility>

#include "engine/core/error.hpp"
#include "hosts/io/sources/folder_camera.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

/// Where the camera file leaves the size to the images.
void take_size_of_images(FolderCamera& camera, const std::vector<fs::path>& color, const fs::path& folder) {
    Intrinsics& K = camera.description.camera.intrinsics;
    if (K.width > 0) return;
    const auto size = first_readable(color, image_file_size);
    if (!size) throw Error(folder.string() + ": none of its first colour images can be read");
    K.width = size->width;
    K.height = size->height;
    if (!(K.cx > 0 && K.cy > 0 && K.cx < static_cast<float>(K.width) && K.cy < static_cast<float>(K.height)))
        throw Error(camera.file.string() + ": its principal point lies outside of the colour images (" +
                    size_text(*size) + "): it is for images of another size; give a fitting one with --camera FILE");
}

}  // namespace

ImageFiles::ImageFiles(const fs::path& folder, const SourceOptions& options, std::vector<FramePaths> frames,
                       std::vector<std::string> warnings)
    : folder_(folder) {
    for (FramePaths& frame : frames) {
        facts_.frames.push_back(std::move(frame.entry));
        color_.push_back(std::move(frame.color));
        depth_.push_back(std::move(frame.depth));
    }
    FolderCamera camera = find_folder_camera(folder, options);
    take_size_of_images(camera, color_, folder);
    depth_files_.emplace(camera.description, camera.depth_coding, depth_, folder.string(), warnings);
    y_up_ = camera.description.y_up;
    facts_.location = folder.string();
    facts_.name = folder_name(folder);
    facts_.camera = camera.description.camera;
    facts_.warnings = std::move(warnings);
}

RawFrame ImageFiles::read(std::size_t i) const {
    const FrameEntry& entry = facts_.frames.at(i);
    const Intrinsics& K = facts_.camera.intrinsics;
    RawFrame frame{entry.stamp, entry.stamp_text, entry.depth_delay, {}, {}, color_[i].string(), depth_[i].string()};
    frame.color = read_color(color_[i], {K.width, K.height});
    frame.depth = depth_files_->read(depth_[i]);
    return frame;
}

std::optional<Trajectory> ImageFiles::groundtruth() const {
    std::vector<NumberedFrame> frames;
    for (std::size_t i = 0; i < color_.size(); ++i) frames.push_back({facts_.frames[i].stamp, color_[i]});
    return folder_groundtruth(folder_, frames, y_up_);
}

}  // namespace posefusion
