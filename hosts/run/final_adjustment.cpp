#include "hosts/run/final_adjustment.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "hosts/adjust/landmarks.hpp"
#include "hosts/run/keyframe_choice.hpp"
#include "hosts/run/run_record.hpp"
#include "hosts/run/run_session.hpp"

namespace posefusion {
namespace {

using Eigen::Isometry3d;

/// A pose on the way from a to b.
Isometry3d between(const Isometry3d& a, const Isometry3d& b, double share) {
    Isometry3d T = Isometry3d::Identity();
    T.translation() = (1 - share) * a.translation() + share * b.translation();
    T.linear() = Eigen::Quaterniond(a.linear()).slerp(share, Eigen::Quaterniond(b.linear())).toRotationMatrix();
    return T;
}

/// The frames of the map as bundle adjustment sees them.
std::vector<LookedFrame> frames_of(const RunRecord& record, const Recording& recording) {
    const PieceRecord& piece = record.pieces.front();
    std::vector<LookedFrame> frames;
    for (std::size_t i = 0; i < piece.frames.size(); ++i) {
        const FrameRecord& frame = record.frames[piece.frames[i]];
        frames.push_back({frame.index, frame.stamp, recording.frames()[frame.index].depth_delay, piece.poses[i],
                          has_pose(frame.result.tracking), frame.not_static});
    }
    return frames;
}

/// Poses of frames, from those of keyframes.
class Trajectories {
public:
    /// @param keyframes  positions in `frames`, ascending  @param adjusted  T_world_camera of each
    Trajectories(const std::vector<LookedFrame>& frames, const std::vector<std::size_t>& keyframes,
                 const std::vector<Isometry3d>& adjusted)
        : frames_(frames), keyframes_(keyframes), adjusted_(adjusted) {}

    /// As its keyframes would have it: tracking knows the way from them, before and after it.
    [[nodiscard]] Isometry3d pose(std::size_t i) const {
        const auto [before, after] = neighbours(i);
        const auto from = [&](std::size_t k) -> Isometry3d {
            return adjusted_[k] * frames_[keyframes_[k]].T_world_camera.inverse() * frames_[i].T_world_camera;
        };
        if (before == after) return from(before);
        const auto at = [&](std::size_t k) { return static_cast<double>(keyframes_[k]); };
        return between(from(before), from(after), (static_cast<double>(i) - at(before)) / (at(after) - at(before)));
    }

    /// The keyframes round a frame.
    [[nodiscard]] std::vector<std::size_t> near(std::size_t i) const {
        const auto [before, after] = neighbours(i);
        constexpr std::size_t kNear = FinalAdjustmentConfig::kNear;
        std::vector<std::size_t> result;
        for (std::size_t k = before + 1 - std::min(before + 1, kNear); k < std::min(after + kNear, keyframes_.size());
             ++k)
            result.push_back(k);
        return result;
    }

private:
    /// The last keyframe that is not after the frame and the first that is not before it.
    [[nodiscard]] std::pair<std::size_t, std::size_t> neighbours(std::size_t i) const {
        const auto at = std::lower_bound(keyframes_.begin(), keyframes_.end(), i);
        const auto after = static_cast<std::size_t>(at - keyframes_.begin());
        if (at == keyframes_.end()) return {after - 1, after - 1};
        return {*at == i || after == 0 ? after : after - 1, after};
    }

    const std::vector<LookedFrame>& frames_;
    const std::vector<std::size_t>& keyframes_;
    const std::vector<Isometry3d>& adjusted_;
};

void add_steps(Bundle& bundle) {
    for (std::uint32_t k = 1; k < bundle.T_camera_world.size(); ++k)
        bundle.steps.push_back({k - 1, k, bundle.T_camera_world[k] * bundle.T_camera_world[k - 1].inverse(),
                                FinalAdjustmentConfig::kStepPosition, FinalAdjustmentConfig::kStepRotation});
}

/// Brings poses and landmarks to agree. @return false: those that are held out do not fit better, nothing has changed
bool adjust_poses(Bundle& bundle, FinalAdjustment& result) {
    using C = FinalAdjustmentConfig;
    const BundleConfig poses_only{.intrinsics = false, .deformation = false};
    Bundle held_out = part_of(bundle, C::kHeldOut, true), trained = part_of(bundle, C::kHeldOut, false);
    result.held_out_before = mean_cost_of(held_out);
    adjust(trained, bundle.camera, poses_only);
    held_out.T_camera_world = trained.T_camera_world;
    result.held_out = mean_cost_of(held_out);
    if (!(result.held_out < (1 - C::kLeastGain) * result.held_out_before)) return false;
    bundle.T_camera_world = trained.T_camera_world;
    adjust(bundle, bundle.camera, poses_only);
    return true;
}

/// The pose of a frame between keyframes by the landmarks that it sees. @return T_world_camera; nullopt: these do not
/// tell, or place it too far from where it is expected
std::optional<Isometry3d> place(const Bundle& bundle, const std::vector<Observation>& seen, const FrameReadout& readout,
                                const Isometry3d& expected) {
    using C = FinalAdjustmentConfig;
    const auto T_camera_world = fit_pose(bundle, seen, readout, expected.inverse());
    if (!T_camera_world) return std::nullopt;
    const Isometry3d off = *T_camera_world * expected;
    if (off.translation().norm() > C::kMostOff || Eigen::AngleAxisd(off.linear()).angle() > C::kMostTurned)
        return std::nullopt;
    return T_camera_world->inverse();
}

/// The first frame stays where it is: there the world begins.
void begin_where_it_began(const std::vector<LookedFrame>& frames, FinalAdjustment& result) {
    const Isometry3d back = frames.front().T_world_camera * result.poses.front().inverse();
    for (std::size_t i = 0; i < frames.size(); ++i) {
        result.poses[i] = back * result.poses[i];
        const double change = (result.poses[i].translation() - frames[i].T_world_camera.translation()).norm();
        result.mean_change_m += change / static_cast<double>(frames.size());
        result.largest_change_m = std::max(result.largest_change_m, change);
    }
}

}  // namespace

std::optional<FinalAdjustment> adjust_at_end(const std::filesystem::path& location, const RunConfig& config,
                                             const RunRecord& record,
                                             const std::function<void(std::size_t, std::size_t)>& progress,
                                             const std::function<bool()>& cancelled) {
    using C = FinalAdjustmentConfig;
    if (!config.final_adjust || config.no_loops || is_camera(location) || !config.load_map.empty() ||
        record.pieces.empty() || record.status != RunStatus::Finished ||
        record.tracked(record.pieces.front()) < C::kFewestFrames)
        return std::nullopt;
    SourceOptions options = source_options(config);
    options.scale = 1;
    const int width = Recording(location, options).intrinsics().width;
    options.scale = std::min(1.0f, C::kWidth / static_cast<float>(width));
    const Recording recording(location, options);
    const std::vector<LookedFrame> frames = frames_of(record, recording);

    FinalAdjustment result;
    const bool rolling = !config.slam.shutter.is_global();
    const std::optional<RowTimes> times = rolling ? std::optional(row_times(config.slam.shutter)) : std::nullopt;
    const std::vector<std::size_t> chosen = choose_views(recording, frames, rolling, C::kKeyframes);
    result.keyframes = chosen.size();
    const auto unchanged = [&](const std::string& reason) {
        result.reason = reason;
        return result;
    };
    if (chosen.size() < C::kFewestKeyframes) return unchanged("the camera has hardly moved");
    std::size_t done = 0;
    const std::size_t total = chosen.size() + frames.size();
    const auto step_done = [&] { progress(++done, total); };
    const std::vector<KeyframeImages> keyframes = load_views(recording, frames, chosen, rolling);
    LandmarkSearch search(keyframes, recording.intrinsics(), config.slam.noise, times);
    Bundle bundle = search.find(step_done);
    result.landmarks = bundle.landmarks.size();
    result.observations = bundle.observations.size();
    if (cancelled()) return std::nullopt;
    if (bundle.landmarks.size() < C::kFewestLandmarks) return unchanged("too few points were found again");
    if (rolling) result.way = choose_way(bundle, frames, chosen);
    add_steps(bundle);

    if (!adjust_poses(bundle, result)) return unchanged("points that had no part in it do not fit better");
    std::vector<Isometry3d> adjusted;
    for (const Isometry3d& T_camera_world : bundle.T_camera_world) adjusted.push_back(T_camera_world.inverse());

    const Trajectories trajectories(frames, chosen, adjusted);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        if (cancelled()) return std::nullopt;
        step_done();
        const Isometry3d expected = trajectories.pose(i);
        result.poses.push_back(expected);
        if (!frames[i].tracked || std::binary_search(chosen.begin(), chosen.end(), i)) continue;
        const KeyframeImages frame = load_views(recording, frames, {i}, rolling).front();
        const std::vector<Observation> seen = search.find_in(frame, trajectories.near(i));
        const auto readout = rolling ? readout_of(frames, i, result.way, false) : std::nullopt;
        const auto placed = place(bundle, seen, readout.value_or(FrameReadout{}), expected);
        if (!placed) continue;
        result.poses.back() = *placed;
        ++result.placed;
    }
    begin_where_it_began(frames, result);
    return result;
}

}  // namespace posefusion
