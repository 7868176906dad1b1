#include "hosts/io/recording.hpp"

#include <algorithm>

namespace posefusion {
namespace {

bool has_depth(const DepthImage& depth) {
    return std::any_of(depth.begin(), depth.end(), [](float d) { return d > 0; });
}

bool is_black(const ColorImage& color) {
    constexpr std::uint8_t kDarkest = 8;  // sensor noise in the dark stays below this grey level
    return std::none_of(color.begin(), color.end(), [](Rgb8 c) { return std::max({c.r, c.g, c.b}) > kDarkest; });
}

}  // namespace

void check_usable(const Frame& frame, const std::string& color_name, const std::string& depth_name) {
    if (is_black(frame.color)) throw Error(color_name + ": colour image is black, no people could be found in it");
    if (!has_depth(frame.depth)) throw Error(depth_name + ": depth image holds no measurement");
}

Recording::Recording(const std::filesystem::path& location, const SourceOptions& options)
    : Recording(open_source(location, options), options.scale) {}

Recording::Recording(std::unique_ptr<FrameSource> source, float scale)
    : source_(std::move(source)), geometry_(source_->camera(), scale) {}

Frame Recording::load(std::size_t i) const {
    RawFrame raw = source_->read(i);
    Frame frame;
    frame.index = i;
    frame.stamp = raw.stamp;
    frame.stamp_text = std::move(raw.stamp_text);
    auto images = geometry_.from_source(std::move(raw.color), to_metres(raw.depth, source_->camera().depth_scale));
    frame.color = std::move(images.color);
    frame.depth = std::move(images.depth);
    frame.undistort = images.undistort;
    check_usable(frame, raw.color_name, raw.depth_name);
    return frame;
}

LabelImage Recording::labels_from_source(const LabelImage& labels) const { return geometry_.from_source(labels); }
LabelImage Recording::labels_to_source(const LabelImage& labels) const { return geometry_.to_source(labels); }

std::string BadFrames::bad(const std::string& reason) {
    ++bad_;
    if (good_ == 0 && bad_ >= total_) throw Error("no frame of the recording can be used; the last fault: " + reason);
    if (good_ == 0 && bad_ >= patience_)
        throw Error("none of the first " + std::to_string(bad_) + " frames can be used; the last fault: " + reason);
    return "frame skipped: " + reason;
}

}  // namespace posefusion
