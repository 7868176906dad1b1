#include "tools/gpu_check/packed_recording.hpp"

#include <stb/stb_image.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>

#include "engine/core/error.hpp"

namespace posefusion {

namespace {

/// @param Sample  of the file, 8 or 16 bits
template <class Sample>
std::unique_ptr<Sample, void (*)(void*)> load_image(const std::filesystem::path& file, const Intrinsics& camera,
                                                    int channels) {
    int width = 0, height = 0, in_file = 0;
    void* samples = nullptr;
    if constexpr (sizeof(Sample) == 2) {
        samples = stbi_load_16(file.c_str(), &width, &height, &in_file, channels);
    } else {
        samples = stbi_load(file.c_str(), &width, &height, &in_file, channels);
    }
    std::unique_ptr<Sample, void (*)(void*)> image(static_cast<Sample*>(samples), &stbi_image_free);
    if (!image) throw Error("'" + file.string() + "': " + stbi_failure_reason() + "; unpack the folder again");
    if (width != camera.width || height != camera.height) {
        throw Error("'" + file.string() + "' has another size than recording.json says; unpack the folder again");
    }
    return image;
}

PackedFrame load_frame(const std::filesystem::path& folder, const nlohmann::json& entry, const Intrinsics& camera,
                       float depth_scale) {
    PackedFrame frame{ColorImage(camera.width, camera.height), DepthImage(camera.width, camera.height),
                      LabelImage(camera.width, camera.height)};
    const auto color = load_image<stbi_uc>(folder / entry.at("color").get<std::string>(), camera, 3);
    const auto depth = load_image<stbi_us>(folder / entry.at("depth").get<std::string>(), camera, 1);
    const auto mask = load_image<stbi_uc>(folder / entry.at("mask").get<std::string>(), camera, 1);
    for (std::size_t i = 0; i < frame.depth.size(); ++i) {
        const stbi_uc* rgb = color.get() + 3 * i;
        frame.color[i] = {rgb[0], rgb[1], rgb[2]};
        frame.depth[i] = static_cast<float>(depth.get()[i]) / depth_scale;
        frame.labels[i] = mask.get()[i];
    }
    return frame;
}

/// The pixel that covers the middle of (u, v) of a smaller or larger image.
template <class Pixel>
Image<Pixel> nearest(const Image<Pixel>& image, const Intrinsics& camera) {
    Image<Pixel> result(camera.width, camera.height);
    for (int v = 0; v < camera.height; ++v) {
        for (int u = 0; u < camera.width; ++u) {
            result(u, v) = image(u * image.width() / camera.width, v * image.height() / camera.height);
        }
    }
    return result;
}

/// Between the pixels of one surface depth is interpolated: steps as wide as two pixels would be noise that no sensor
/// has.
DepthImage enlarged(const DepthImage& image, const Intrinsics& camera) {
    constexpr float kSameSurface = 0.03f;  // share of the depth
    DepthImage result = nearest(image, camera);
    const float step = static_cast<float>(image.width()) / static_cast<float>(camera.width);
    for (int v = 0; v < camera.height; ++v) {
        for (int u = 0; u < camera.width; ++u) {
            const float x = std::max(0.0f, (static_cast<float>(u) + 0.5f) * step - 0.5f);
            const float y = std::max(0.0f, (static_cast<float>(v) + 0.5f) * step - 0.5f);
            const int u0 = std::min(static_cast<int>(x), image.width() - 2);
            const int v0 = std::min(static_cast<int>(y), image.height() - 2);
            const float a = x - static_cast<float>(u0), b = y - static_cast<float>(v0);
            const float corners[] = {image(u0, v0), image(u0 + 1, v0), image(u0, v0 + 1), image(u0 + 1, v0 + 1)};
            const auto [low, high] = std::minmax_element(std::begin(corners), std::end(corners));
            if (*low <= 0 || *high - *low > kSameSurface * *low) continue;
            result(u, v) =
                (1 - b) * ((1 - a) * corners[0] + a * corners[1]) + b * ((1 - a) * corners[2] + a * corners[3]);
        }
    }
    return result;
}

}  // namespace

PackedRecording read_packed_recording(const std::filesystem::path& folder, std::size_t max_frames) {
    const std::filesystem::path file = folder / "recording.json";
    std::ifstream stream(file);
    if (!stream) throw Error("cannot read '" + file.string() + "'; name a folder that tools/gpu_check/pack made");
    PackedRecording recording;
    try {
        const auto json = nlohmann::json::parse(stream);
        const auto& camera = json.at("camera");
        recording.camera = {camera.at("fx"), camera.at("fy"),    camera.at("cx"),
                            camera.at("cy"), camera.at("width"), camera.at("height")};
        for (const auto& entry : json.at("frames")) {
            if (max_frames > 0 && recording.frames.size() == max_frames) break;
            recording.frames.push_back(load_frame(folder, entry, recording.camera, camera.at("depth_scale")));
        }
    } catch (const nlohmann::json::exception& fault) {
        throw Error("'" + file.string() + "': " + fault.what() + "; unpack the folder again");
    }
    if (recording.frames.empty()) throw Error("'" + file.string() + "' names no frames; unpack the folder again");
    return recording;
}

PackedRecording resized(const PackedRecording& recording, int width) {
    const Intrinsics& from = recording.camera;
    if (width == from.width) return recording;
    const float factor = static_cast<float>(width) / static_cast<float>(from.width);
    PackedRecording result;
    result.camera = from.scaled(factor);
    if (factor < 1) {  // the pixel taken is the top left one of its block
        result.camera.cx = from.cx * factor;
        result.camera.cy = from.cy * factor;
    }
    for (const PackedFrame& frame : recording.frames) {
        result.frames.push_back(
            {nearest(frame.color, result.camera),
             factor > 1 ? enlarged(frame.depth, result.camera) : nearest(frame.depth, result.camera),
             nearest(frame.labels, result.camera)});
    }
    return result;
}

}  // namespace posefusion
