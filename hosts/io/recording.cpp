#include "hosts/io/recording.hpp"

#include <algorithm>
#include <cmath>

#include "engine/core/median.hpp"
#include "engine/core/number_text.hpp"
#include "hosts/io/depth_unit.hpp"

namespace posefusion {
namespace {

/// A longer row of unusable frames is shown in part: every kShownOfMany-th.
constexpr std::size_t kShownInARow = 5, kShownOfMany = 100;

bool has_depth(const DepthImage& depth, const DepthRange& range) {
    return std::any_of(depth.begin(), depth.end(), [&](float d) { return d > 0 && d >= range.min && d <= range.max; });
}

/// Why an image without depth in the range has none.
std::string missing_depth(const DepthImage& depth, const DepthRange& range) {
    std::vector<float> measured;
    std::copy_if(depth.begin(), depth.end(), std::back_inserter(measured), [](float d) { return d > 0; });
    if (measured.empty()) return "depth image holds no measurement";
    return "no depth between " + shortest_text(range.min) + " and " + shortest_text(range.max) +
           " m (preprocess.depth_min, depth_max), the median is " +
           fixed_text(static_cast<double>(upper_median(measured)), 2) + " m; is depth_scale in the camera file right?";
}

bool is_black(const ColorImage& color) {
    constexpr std::uint8_t kDarkest = 8;  // sensor noise in the dark stays below this grey level
    return std::none_of(color.begin(), color.end(), [](Rgb8 c) { return std::max({c.r, c.g, c.b}) > kDarkest; });
}

}  // namespace

void check_usable(const Frame& frame, const DepthRange& range, const std::string& color_name,
                  const std::string& depth_name) {
    if (is_black(frame.color)) throw Error(color_name + ": colour image is black, no people could be found in it");
    if (!has_depth(frame.depth, range)) throw Error(depth_name + ": " + missing_depth(frame.depth, range));
}

Recording::Recording(const std::filesystem::path& location, const SourceOptions& options)
    : Recording(open_source(location, options), options.scale) {
    if (options.calibrated) geometry_ = ImageGeometry(*options.calibrated, options.scale);
    depth_range_ = options.depth;
    if (const auto warning = check_depth_unit(*source_)) warnings_.push_back(*warning);
}

Recording::Recording(std::unique_ptr<FrameSource> source, float scale)
    : source_(std::move(source)), geometry_(source_->camera(), scale), warnings_(source_->facts().warnings) {}

const FrameEntry* Recording::frame_at(std::size_t place) const {
    const std::vector<std::size_t>& places = source_->facts().places;
    if (places.empty()) return place < frames().size() ? &frames()[place] : nullptr;
    const auto found = std::lower_bound(places.begin(), places.end(), place);
    const bool selected = found != places.end() && *found == place;
    return selected ? &frames()[static_cast<std::size_t>(found - places.begin())] : nullptr;
}

Frame Recording::load(std::size_t i) const {
    RawFrame raw = source_->read(i);
    Frame frame;
    frame.index = i;
    frame.stamp = raw.stamp;
    frame.stamp_text = std::move(raw.stamp_text);
    frame.depth_delay = raw.depth_delay;
    auto images = geometry_.from_source(std::move(raw.color), to_metres(raw.depth, source_->camera().depth_scale));
    frame.color = std::move(images.color);
    frame.depth = std::move(images.depth);
    frame.undistort = images.undistort;
    check_usable(frame, depth_range_, raw.color_name, raw.depth_name);
    return frame;
}

LabelImage Recording::labels_from_source(const LabelImage& labels) const { return geometry_.from_source(labels); }
LabelImage Recording::labels_to_source(const LabelImage& labels) const { return geometry_.to_source(labels); }

std::string BadFrames::bad(const std::string& reason) {
    ++bad_;
    ++in_a_row_;
    if (good_ == 0 && bad_ >= total_) throw Error("no frame of the recording can be used; the last fault: " + reason);
    if (in_a_row_ < kShownInARow) return "frame skipped: " + reason;
    if (in_a_row_ == kShownInARow)
        return "frame skipped: " + reason + " (of more in a row, every " + std::to_string(kShownOfMany) +
               "th is shown)";
    if (in_a_row_ % kShownOfMany != 0) return "";
    return std::to_string(in_a_row_) + " frames in a row skipped, the last: " + reason;
}

void BadFrames::good() {
    ++good_;
    in_a_row_ = 0;
}

}  // namespace posefusion
