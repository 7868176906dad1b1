#include "hosts/run/keyframe_choice.hpp"

#include <algorithm>
#include <cmath>

namespace posefusion {
namespace {

using Eigen::Isometry3d;

double turn(const Isometry3d& T) { return Eigen::AngleAxisd(T.linear()).angle(); }

double median_depth(const DepthImage& depth) {
    std::vector<float> measured;
    std::copy_if(depth.begin(), depth.end(), std::back_inserter(measured), [](float d) { return d > 0; });
    if (measured.empty()) return 1;
    std::nth_element(measured.begin(), measured.begin() + static_cast<std::ptrdiff_t>(measured.size() / 2),
                     measured.end());
    return static_cast<double>(measured[measured.size() / 2]);
}

}  // namespace

ViewDistance::ViewDistance(const Recording& recording, const std::vector<LookedFrame>& frames) {
    const auto first = std::find_if(frames.begin(), frames.end(), [](const LookedFrame& f) { return f.tracked; });
    if (first != frames.end()) depth_ = median_depth(recording.load(first->index).depth);
}

double ViewDistance::operator()(const Isometry3d& a, const Isometry3d& b) const {
    const Isometry3d T = a.inverse() * b;
    return std::hypot(T.translation().norm() / (KeyframeChoice::kStep * depth_), turn(T) / KeyframeChoice::kTurn);
}

std::vector<std::size_t> choose_views(const std::vector<LookedFrame>& frames, const ViewDistance& distance,
                                      bool rolling, std::size_t most) {
    std::vector<std::size_t> usable;
    for (std::size_t i = 0; i < frames.size(); ++i)
        if (frames[i].tracked && (!rolling || readout_of(frames, i, Way::Smooth, true))) usable.push_back(i);
    for (double least = 1;; least *= 1.2) {
        std::vector<std::size_t> chosen;
        for (const std::size_t i : usable) {
            const bool is_new = std::all_of(chosen.begin(), chosen.end(), [&](std::size_t k) {
                return distance(frames[k].T_world_camera, frames[i].T_world_camera) > least;
            });
            if (is_new) chosen.push_back(i);
        }
        if (chosen.size() <= most) return chosen;
    }
}

std::optional<FrameReadout> readout_of(const std::vector<LookedFrame>& frames, std::size_t i, Way way, bool both) {
    constexpr std::size_t kEachSide = ReadoutMotion::kMostNeighbours / 2;
    const Isometry3d T_frame_world = frames[i].T_world_camera.inverse();
    std::vector<ReadoutMotion::Neighbour> neighbours;
    const auto add = [&](std::size_t k) {
        const double since = to_seconds(frames[k].stamp - frames[i].stamp);
        const bool usable = frames[k].tracked && std::abs(since) < KeyframeChoice::kNeighbours_s;
        if (usable) neighbours.push_back({since, T_frame_world * frames[k].T_world_camera});
        return usable;
    };
    for (std::size_t d = 1; d <= std::min(kEachSide, i) && add(i - d); ++d) continue;
    const std::size_t before = neighbours.size();
    for (std::size_t d = 1; d <= kEachSide && i + d < frames.size() && add(i + d); ++d) continue;
    if (neighbours.empty()) return std::nullopt;
    FrameReadout readout{ReadoutMotion(neighbours, way), to_seconds(frames[i].depth_delay)};
    if (before == 0) readout.unknown = ReadoutMotion::Side::Before;
    if (neighbours.size() == before) readout.unknown = ReadoutMotion::Side::After;
    if (both && readout.unknown) return std::nullopt;
    return readout;
}

std::vector<KeyframeImages> load_views(const Recording& recording, const std::vector<LookedFrame>& frames,
                                       const std::vector<std::size_t>& at, bool rolling) {
    std::vector<KeyframeImages> views;
    for (const std::size_t i : at) {
        Frame frame = recording.load(frames[i].index);
        const auto readout = rolling ? readout_of(frames, i, Way::Smooth, false) : std::nullopt;
        views.push_back({std::move(frame.color), std::move(frame.depth), frames[i].labels, frames[i].T_world_camera,
                         readout.value_or(FrameReadout{})});
    }
    return views;
}

Way choose_way(Bundle& bundle, const std::vector<LookedFrame>& frames, const std::vector<std::size_t>& at) {
    const BundleConfig poses_only{.intrinsics = false, .deformation = false};
    Bundle straight = bundle;
    for (std::size_t k = 0; k < at.size(); ++k)
        if (const auto readout = readout_of(frames, at[k], Way::Straight, false)) straight.readouts[k] = *readout;
    Bundle smoothly = bundle, straightly = straight;
    const double cost = adjust(smoothly, bundle.camera, poses_only).cost;
    if (!(adjust(straightly, bundle.camera, poses_only).cost < KeyframeChoice::kStraight * cost)) return Way::Smooth;
    bundle = std::move(straight);
    return Way::Straight;
}

RowTimes row_times(const ShutterConfig& shutter) {
    constexpr double kSeconds = 1e-3;
    return {kSeconds * static_cast<double>(shutter.depth_delay_ms),
            kSeconds * static_cast<double>(shutter.depth_readout_ms),
            kSeconds * static_cast<double>(shutter.color_readout_ms), static_cast<double>(shutter.stamp_row)};
}

}  // namespace posefusion
