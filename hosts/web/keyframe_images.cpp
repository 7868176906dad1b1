#include "hosts/web/keyframe_images.hpp"

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "engine/core/error.hpp"
#include "hosts/io/image_file.hpp"
#include "hosts/io/recording.hpp"
#include "hosts/run/finished_run.hpp"

namespace posefusion {
namespace {

namespace fs = std::filesystem;
constexpr int kMostPixels = 320;         // wide: sharp in the corner of a page, 15 kB each
constexpr std::size_t kMostImages = 60;  // 1 MB of a page that is to be mailed
constexpr int kJpegQuality = 80;

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

ColorImage small_picture(const ColorImage& image) {
    if (image.width() <= kMostPixels) return image;
    ColorImage small(kMostPixels, std::max(1, image.height() * kMostPixels / image.width()));
    const cv::Mat from(image.height(), image.width(), CV_8UC3, const_cast<Rgb8*>(image.data()));
    cv::Mat to(small.height(), small.width(), CV_8UC3, small.data());
    cv::resize(from, to, to.size(), 0, 0, cv::INTER_AREA);
    return small;
}

std::string jpeg_of(const ColorImage& picture) { return encode_jpeg(picture, kJpegQuality); }

std::string add_keyframe_images(WebScene& scene, const fs::path& folder, const fs::path& recording_now,
                                const std::function<bool()>& cancelled) {
    if (scene.keyframes.empty()) return {};
    try {
        const FinishedRun run = read_finished_run(folder, recording_now);
        const Recording recording(run.recording, run.source_options());
        for (const std::size_t place : chosen(scene.keyframes.size())) {
            if (cancelled()) return {};
            SceneKeyframe& keyframe = scene.keyframes[place];
            const auto frame = frame_with(recording, run.trajectory[keyframe.pose].stamp);
            if (frame) keyframe.jpeg = jpeg_of(small_picture(recording.load(*frame).color));
        }
        const bool any = std::any_of(scene.keyframes.begin(), scene.keyframes.end(),
                                     [](const SceneKeyframe& keyframe) { return !keyframe.jpeg.empty(); });
        return any ? "" : run.recording.string() + " holds none of the frames of the run";
    } catch (const Error& error) {
        return error.what();
    }
}

}  // namespace posefusion
