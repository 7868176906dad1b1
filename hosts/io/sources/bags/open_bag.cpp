#include "hosts/io/sources/bags/open_bag.hpp"

#include <algorithm>
#include <cctype>
#include <string>
#include <utility>

#include "engine/core/error.hpp"
#include "hosts/io/sources/bags/bag_source.hpp"
#include "hosts/io/sources/bags/db3_bag.hpp"
#include "hosts/io/sources/bags/mcap_bag.hpp"
#include "hosts/io/sources/bags/ros1_bag.hpp"
#include "hosts/io/sources/bags/rosbag2_folder.hpp"
#include "hosts/io/sources/bags/unpacked_file.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;

std::string extension_of(const fs::path& file) {
    std::string text = file.extension().string();
    std::transform(text.begin(), text.end(), text.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return text;
}

bool is_packed(const fs::path& file) { return extension_of(file) == ".zstd" || extension_of(file) == ".zst"; }

/// "x.db3" of "x.db3.zstd"
fs::path name_of(const fs::path& file) { return is_packed(file) ? file.stem() : file.filename(); }

bool is_ros2_extension(const std::string& extension) { return extension == ".mcap" || extension == ".db3"; }

/// @param shown  its name in messages
std::unique_ptr<MessageBag> open_ros2_file(const fs::path& file, const std::string& extension,
                                           const std::string& shown) {
    if (extension == ".mcap") return std::make_unique<McapBag>(file, shown);
    return std::make_unique<Db3Bag>(file, shown);
}

}  // namespace

bool is_bag_file(const fs::path& file) {
    return is_ros2_extension(extension_of(name_of(file))) || extension_of(file) == ".bag";
}

std::unique_ptr<MessageBag> open_bag_file(const fs::path& file) {
    const std::string extension = extension_of(name_of(file));
    if (extension == ".bag") return std::make_unique<Ros1Bag>(file);
    if (!is_packed(file)) return open_ros2_file(file, extension, file.string());
    const UnpackedFile unpacked(file);  // stays readable while it is open
    return open_ros2_file(unpacked.path(), extension, file.string());
}

std::unique_ptr<FrameSource> open_bag(const fs::path& location, const SourceOptions& options) {
    std::error_code error;
    if (!fs::is_directory(location, error))
        return frames_of_bag(open_bag_file(location), name_of(location).stem().string(), options);
    const fs::path folder = fs::absolute(location).lexically_normal();
    const fs::path last = folder.has_filename() ? folder.filename() : folder.parent_path().filename();
    return frames_of_bag(std::make_unique<Rosbag2Folder>(location), last.string(), options);
}

}  // namespace posefusion
