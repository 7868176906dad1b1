#include <algorithm>
#include <cctype>
#include <utility>

#include "hosts/io/frame_source.hpp"
#include "hosts/io/sources/bags/open_bag.hpp"
#include "hosts/io/sources/bags/rosbag2_folder.hpp"
#include "hosts/io/sources/image_folder_source.hpp"
#include "hosts/io/sources/klg_source.hpp"
#include "hosts/io/sources/oni_source.hpp"
#include "hosts/io/sources/openni_source.hpp"
#include "hosts/io/sources/raw_stream.hpp"
#include "hosts/io/sources/selected_frames.hpp"
#include "hosts/io/sources/tum_source.hpp"
#include "hosts/io/sources/video/azure_source.hpp"
#include "hosts/io/sources/video/stray_source.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kCameraScheme = "openni2:", kStreamScheme = "raw:";

std::string extension_of(const fs::path& file) {
    std::string text = file.extension().string();
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

std::unique_ptr<FrameSource> open_recording(const fs::path& location, const SourceOptions& options) {
    const std::string text = location.string();
    std::error_code error;
    if (!fs::exists(location, error))
        throw Error(text + ": recording not found; give a folder, a file, openni2: or raw:-");
    const bool folder = fs::is_directory(location, error);
    if (!options.associations_file.empty() && !folder)
        throw Error(text + ": is not a folder, --associations has no meaning for it");
    if (folder) {
        const bool lists = !options.associations_file.empty() || is_tum_folder(location);
        if (lists) return open_tum_folder(location, options);
        if (is_stray_folder(location)) return open_stray_folder(location, options);
        return is_rosbag2_folder(location) ? open_bag(location, options) : open_image_folder(location, options);
    }
    const std::string extension = extension_of(location);
    if (is_bag_file(location)) return open_bag(location, options);
    if (extension == ".klg") return open_klg(location, options);
    if (extension == ".oni") return open_oni(location, options);
    if (extension == ".mkv") return open_azure(location, options);
    throw Error(text + ": is not a folder, nor a recording that can be read (.klg, .bag, .mcap, .db3, .oni, .mkv)");
}

}  // namespace

bool is_camera(const fs::path& location) {
    const std::string text = location.string();
    return text.starts_with(kCameraScheme) || text.starts_with(kStreamScheme);
}

std::unique_ptr<FrameSource> open_source(const fs::path& location, const SourceOptions& options) {
    const std::string text = location.string();
    if (text.starts_with(kStreamScheme)) {
        if (text != std::string(kStreamScheme) + "-")
            throw Error(text + ": frames can be read from standard input only; write raw:-");
        return select_frames(open_raw_stream(options), options.selection);
    }
    if (text.starts_with(kCameraScheme))
        return select_frames(open_openni_camera(text.substr(kCameraScheme.size()), options), options.selection);
    auto recording = open_recording(location, options);
    recording->warn_of_pauses();
    return select_frames(std::move(recording), options.selection);
}

}  // namespace posefusion
