#include "hosts/web/keyframe_images.hpp"

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "engine/core/error.hpp"
#include "hosts/config/config_file.hpp"
#include "hosts/config/option_table.hpp"
#include "hosts/io/image_file.hpp"
#include "hosts/io/recording.hpp"
#include "hosts/run/run_session.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;
constexpr int kMostPixels = 320;         // wide: sharp in the corner of a page, 15 kB each
constexpr std::size_t kMostImages = 60;  // 1 MB of a page that is to be mailed
constexpr int kJpegQuality = 80;

ColorImage shrunk(const ColorImage& image) {
    if (image.width() <= kMostPixels) return image;
    ColorImage small(kMostPixels, std::max(1, image.height() * kMostPixels / image.width()));
    const cv::Mat from(image.height(), image.width(), CV_8UC3, const_cast<Rgb8*>(image.data()));
    cv::Mat to(small.height(), small.width(), CV_8UC3, small.data());
    cv::resize(from, to, to.size(), 0, 0, cv::INTER_AREA);
    return small;
}

Recording open_recording(const fs::path& folder, const RunResults& results) {
    RunConfig config;
    if (const fs::path file = folder / "config.yaml"; fs::exists(file)) load_config(file, option_table(config));
    return Recording(results.recording, source_options(config));
}

/// Keyframes from the first to the last, evenly.
std::vector<std::size_t> chosen(std::size_t keyframes) {
    const std::size_t count = std::min(keyframes, kMostImages);
    std::vector<std::size_t> places;
    for (std::size_t i = 0; i < count; ++i) places.push_back(count == 1 ? 0 : i * (keyframes - 1) / (count - 1));
    return places;
}

std::optional<std::size_t> frame_with(const Recording& recording, Stamp stamp) {
    const auto& frames = recording.frames();
    const auto at = std::lower_bound(frames.begin(), frames.end(), stamp,
                                     [](const FrameEntry& frame, Stamp wanted) { return frame.stamp < wanted; });
    if (at == frames.end() || at->stamp != stamp) return std::nullopt;
    return static_cast<std::size_t>(at - frames.begin());
}

}  // namespace

std::string add_keyframe_images(WebScene& scene, const fs::path& folder, const RunResults& results,
                                const std::function<bool()>& cancelled) {
    if (scene.keyframes.empty()) return {};
    if (results.recording.empty()) return "the run does not say where its recording is";
    if (is_camera(results.recording)) return "the run was one with a camera";
    if (!fs::exists(results.recording)) return "the recording " + results.recording + " is not there";
    try {
        const Recording recording = open_recording(folder, results);
        for (const std::size_t place : chosen(scene.keyframes.size())) {
            if (cancelled()) break;
            SceneKeyframe& keyframe = scene.keyframes[place];
            const auto frame = frame_with(recording, results.trajectory[keyframe.pose].stamp);
            if (frame) keyframe.jpeg = encode_jpeg(shrunk(recording.load(*frame).color), kJpegQuality);
        }
    } catch (const Error& error) {
        return error.what();
    }
    const bool any = std::any_of(scene.keyframes.begin(), scene.keyframes.end(),
                                 [](const SceneKeyframe& keyframe) { return !keyframe.jpeg.empty(); });
    return any || cancelled() ? "" : results.recording + " holds none of the frames of the run";
}

}  // namespace posefusion
