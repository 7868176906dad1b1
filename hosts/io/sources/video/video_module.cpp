#include "engine/core/loaded_module.hpp"
#include "hosts/io/sources/video/video_file.hpp"

namespace posefusion {

VideoFile open_video(const std::filesystem::path& file) {
    static OpenVideoByLibav* const by_libav =
        function_of_module<OpenVideoByLibav>(POSEFUSION_VIDEO_MODULE, "open_video_by_libav");
    VideoFile video;
    by_libav(file, video);
    return video;
}

bool has_video() { return true; }

}  // namespace posefusion
