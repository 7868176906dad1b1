// In place of video_module.cpp where FFmpeg's libraries are not wanted or not there.
#include "engine/core/error.hpp"
#include "hosts/io/sources/video/video_file.hpp"

namespace posefusion {

VideoFile open_video(const std::filesystem::path& file) {
    throw Error(file.string() +
                ": this program was built without video; install libavformat-dev and libswscale-dev and build with "
                "POSEFUSION_VIDEO=ON");
}

bool has_video() { return false; }

}  // namespace posefusion
