#pragma once
#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "hosts/io/image_file.hpp"
#include "hosts/io/stamp.hpp"

/// The images of video files, Matroska and MP4, one by one. FFmpeg's libraries, which do the work, are in a module that
/// is loaded with the first such file: Debian's build of them is under the GPL, and nothing else needs them.
namespace posefusion {

struct VideoTrack {
    std::string name;           ///< of Matroska; else empty
    ImageSize size;             ///< of its images
    std::vector<Stamp> stamps;  ///< of its images, ascending
};

struct VideoFile {
    std::vector<VideoTrack> tracks;
    std::map<std::string, std::string> attachments;  ///< files in the file, by their names: the bytes of each
    // Image i of a track, in any order, the next one fastest. May be called from several threads. Throw Error naming
    // the file and the image: it is damaged, or of another size or kind. (No virtual functions: types with them are not
    // the same in the module as they are outside.)
    std::function<ColorImage(std::size_t track, std::size_t i)> color;
    std::function<RawDepth(std::size_t track, std::size_t i)> grey16;  ///< uncompressed 16 bit, `Y16 ` or b16g
};

/// Throws Error: it is no video that can be read, it holds no image, or this program was built without video.
[[nodiscard]] VideoFile open_video(const std::filesystem::path& file);

/// Whether this program was built with it.
[[nodiscard]] bool has_video();

/// The function of the module, which stays loaded.
extern "C" {
using OpenVideoByLibav = void(const std::filesystem::path& file, VideoFile& video);
OpenVideoByLibav open_video_by_libav;
}

}  // namespace posefusion
