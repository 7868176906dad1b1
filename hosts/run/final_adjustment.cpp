#include "hosts/run/final_adjustment.hpp"

#include <algorithm>
#include <cmath>
#include <set>
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

/// By the frames of the map: was it tracked before something large was seen to move, and may have gone along with it?
std::vector<bool> frames_taken_in(const RunRecord& record) {
    using C = FinalAdjustmentConfig;
    const std::vector<std::size_t>& frames = record.pieces.front().frames;
    const auto share = [&](std::size_t i) { return record.frames[frames[i]].result.moving_share; };
    std::vector<bool> taken_in(frames.size(), false);
    for (std::size_t i = 1; i < frames.size(); ++i) {
        if (share(i) - share(i - 1) < C::kRevealed) continue;
        for (std::size_t back = 1; back <= std::min(C::kUnnoticed, i) && share(i - back) < 0.5f * share(i); ++back)
            taken_in[i - back] = true;
    }
    return taken_in;
}

/// Poses of frames, from those of keyframes.
class Trajectories {
public:
    /// @param keyframes  positions in `frames`, ascending  @param adjusted  the keyframes
    Trajectories(const std::vector<LookedFrame>& frames, const std::vector<std::size_t>& keyframes,
                 const Bundle& adjusted)
        : frames_(frames), keyframes_(keyframes) {
        for (const Isometry3d& T_camera_world : adjusted.T_camera_world) adjusted_.push_back(T_camera_world.inverse());
    }

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

    /// The keyframes round a frame, and those that saw about the same at another time. Ascending.
    [[nodiscard]] std::vector<std::size_t> near(std::size_t i, const ViewDistance& distance) const {
        using C = FinalAdjustmentConfig;
        const auto [before, after] = neighbours(i);
        const auto last = keyframes_.size() - 1;
        std::set<std::size_t> result;
        for (std::size_t d = 0; d < C::kNear; ++d) {
            result.insert(before - std::min(before, d));
            result.insert(std::min(after + d, last));
        }
        std::vector<std::pair<double, std::size_t>> others;
        const Isometry3d T_world_camera = pose(i);
        for (std::size_t k = 0; k < keyframes_.size(); ++k)
            others.emplace_back(distance(adjusted_[k], T_world_camera), k);
        const auto most = others.begin() + static_cast<std::ptrdiff_t>(std::min(C::kSimilar, others.size()));
        std::partial_sort(others.begin(), most, others.end());
        std::for_each(others.begin(), most, [&](const auto& other) { result.insert(other.second); });
        return {result.begin(), result.end()};
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
    std::vector<Isometry3d> adjusted_;
};

void add_steps(Bundle& bundle) {
    for (std::uint32_t k = 1; k < bundle.T_camera_world.size(); ++k)
        bundle.steps.push_back({k - 1, k, bundle.T_camera_world[k] * bundle.T_camera_world[k - 1].inverse(),
                                FinalAdjustmentConfig::kStepPosition, FinalAdjustmentConfig::kStepRotation});
}

/// Brings poses and landmarks to agree. @param given  calibration  @param times  those of the rows are unknown, too
/// @param held_out  mean cost of the landmarks that have no part in it, before and after
/// @param most  for this part of it before
/// @return false: they do not fit as well as that, nothing has changed
bool adjust_poses(Bundle& bundle, const CameraParameters& given, bool times, double most, double& held_out) {
    using C = FinalAdjustmentConfig;
    const BundleConfig config{.intrinsics = false, .deformation = false, .times = times};
    Bundle others = part_of(bundle, C::kHeldOut, true), trained = part_of(bundle, C::kHeldOut, false);
    adjust(trained, given, config);
    others.T_camera_world = trained.T_camera_world;
    others.camera = trained.camera;
    const double after = mean_cost_of(others);
    if (!(after < most * held_out)) return false;
    held_out = after;
    bundle.T_camera_world = trained.T_camera_world;
    bundle.camera = trained.camera;
    adjust(bundle, given, config);
    return true;
}

/// The pose of a frame between keyframes by the landmarks that it sees. @return T_world_camera; nullopt: these do not
/// tell, or place it too far from where it is expected
/// @param vague  how many times less is known of that than usual
std::optional<Isometry3d> place(const Bundle& bundle, const std::vector<Observation>& seen, const FrameReadout& readout,
                                const Isometry3d& expected, double vague = 1) {
    using C = FinalAdjustmentConfig;
    const auto T_camera_world =
        fit_pose(bundle, seen, readout, {expected.inverse(), vague * C::kStepPosition, vague * C::kStepRotation});
    if (!T_camera_world) return std::nullopt;
    const Isometry3d off = *T_camera_world * expected;
    if (off.translation().norm() > vague * C::kMostOff ||
        Eigen::AngleAxisd(off.linear()).angle() > vague * C::kMostTurned)
        return std::nullopt;
    return T_camera_world->inverse();
}

/// The frames of a run, of which some are keyframes.
class Adjuster {
public:
    /// @param taken_in  by frames: something that moves took the camera along
    Adjuster(const Recording& recording, const std::vector<LookedFrame>& frames, std::vector<bool> taken_in,
             const RunConfig& config, const std::function<void(std::size_t, std::size_t)>& progress,
             const std::function<bool()>& cancelled)
        : recording_(recording),
          tracked_(frames),
          frames_(frames),
          taken_in_(std::move(taken_in)),
          config_(config),
          progress_(progress),
          cancelled_(cancelled),
          distance_(recording, frames),
          rolling_(!config.slam.shutter.is_global()),
          chosen_(choose_keyframes()) {}

    /// @return nullopt: cancelled
    std::optional<FinalAdjustment> run() {
        using C = FinalAdjustmentConfig;
        result_.keyframes = chosen_.size();
        if (chosen_.size() < C::kFewestKeyframes) return unchanged("the camera has hardly moved");
        const std::vector<KeyframeImages> keyframes = load_views(recording_, frames_, chosen_, rolling_);
        const std::optional<RowTimes> times = rolling_ ? std::optional(row_times(config_.slam.shutter)) : std::nullopt;
        LandmarkSearch search(keyframes, recording_.intrinsics(), config_.slam.noise, times);
        Bundle bundle = search.find([this] { step_done(); });
        result_.landmarks = bundle.landmarks.size();
        result_.observations = bundle.observations.size();
        if (cancelled_()) return std::nullopt;
        if (bundle.landmarks.size() < C::kFewestLandmarks) return unchanged("too few points were found again");
        for (std::size_t i = frames_.size(); i-- > 0;)
            if (taken_in_[i]) take_back(i, bundle, search);
        if (rolling_) result_.way = choose_way(bundle, frames_, chosen_);
        add_steps(bundle);
        return adjust_in_rounds(std::move(bundle), search);
    }

private:
    std::optional<FinalAdjustment> adjust_in_rounds(Bundle bundle, const LandmarkSearch& search) {
        using C = FinalAdjustmentConfig;
        result_.held_out_before = result_.held_out = mean_cost_of(part_of(bundle, C::kHeldOut, true));
        const bool find_times = rolling_ && config_.sensor_timing == SensorTimingMode::Auto;
        const CameraParameters given = bundle.camera;
        std::vector<std::vector<Observation>> seen;  // by the frames between keyframes
        for (int round = 0; round < (rolling_ ? C::kRounds : 1); ++round) {
            if (round > 0) know_motion_better(bundle);
            const double most = round > 0 ? 1 + C::kMostLoss : 1 - C::kLeastGain;
            if (!adjust_poses(bundle, given, find_times, most, result_.held_out)) break;
            const Trajectories trajectories(frames_, chosen_, bundle);
            if (round == 0) {
                for (std::size_t i = 0; i < frames_.size(); ++i) {
                    if (cancelled_()) return std::nullopt;
                    seen.push_back(look(i, trajectories, search));
                    step_done();
                }
            }
            place_all(trajectories, bundle, seen);
            if (find_times) result_.times = times_of(bundle.camera, bundle.stamp_row);
        }
        if (result_.poses.empty()) return unchanged("points that had no part in it do not fit better");
        begin_where_it_began();
        return std::move(result_);
    }

    [[nodiscard]] std::vector<std::size_t> choose_keyframes() const {
        std::vector<LookedFrame> candidates = tracked_;
        for (std::size_t i = 0; i < frames_.size(); ++i)
            if (taken_in_[i]) candidates[i].tracked = false;
        return choose_views(candidates, distance_, rolling_, FinalAdjustmentConfig::kKeyframes);
    }

    [[nodiscard]] FinalAdjustment unchanged(const std::string& reason) {
        result_.reason = reason;
        return std::move(result_);
    }

    void step_done() { progress_(++done_, chosen_.size() + frames_.size()); }

    /// Places a frame that was taken in, by the landmarks of keyframes that were not. The frames after it are right:
    /// from them it is as far as was tracked, or as far as from them to those after them.
    void take_back(std::size_t i, const Bundle& bundle, const LandmarkSearch& search) {
        using C = FinalAdjustmentConfig;
        std::vector<Isometry3d> expected;
        const auto after = next_tracked(i + 1);
        if (!frames_[i].tracked || !after) return;
        const Isometry3d& T_world_after = frames_[*after].T_world_camera;
        expected.push_back(T_world_after * tracked_[*after].T_world_camera.inverse() * tracked_[i].T_world_camera);
        if (const auto later = next_tracked(*after + 1)) {
            const double share = to_seconds(frames_[*after].stamp - frames_[i].stamp) /
                                 to_seconds(frames_[*later].stamp - frames_[*after].stamp);
            const Isometry3d back = frames_[*later].T_world_camera.inverse() * T_world_after;
            expected.push_back(T_world_after * between(Isometry3d::Identity(), back, share));
        }
        std::vector<Observation> most;
        Isometry3d best = expected.front();
        for (const Isometry3d& T_world_camera : expected) {
            frames_[i].T_world_camera = T_world_camera;
            std::vector<Observation> seen = look(i, Trajectories(frames_, chosen_, bundle), search);
            if (seen.size() <= most.size()) continue;
            most = std::move(seen);
            best = T_world_camera;
        }
        frames_[i].T_world_camera = best;
        const auto readout = rolling_ ? readout_of(frames_, i, Way::Smooth, false) : std::nullopt;
        frames_[i].T_world_camera =
            place(bundle, most, readout.value_or(FrameReadout{}), best, C::kVague).value_or(best);
    }

    [[nodiscard]] std::optional<std::size_t> next_tracked(std::size_t i) const {
        while (i < frames_.size() && !frames_[i].tracked) ++i;
        return i < frames_.size() ? std::optional(i) : std::nullopt;
    }

    /// How the camera moved during read-out, by the poses as far as they are adjusted.
    void know_motion_better(Bundle& bundle) const {
        const std::vector<LookedFrame> adjusted = adjusted_frames();
        for (std::size_t k = 0; k < chosen_.size(); ++k)
            if (const auto readout = readout_of(adjusted, chosen_[k], result_.way, false))
                bundle.readouts[k] = *readout;
    }

    [[nodiscard]] std::vector<LookedFrame> adjusted_frames() const {
        std::vector<LookedFrame> adjusted = frames_;
        for (std::size_t i = 0; i < result_.poses.size(); ++i) adjusted[i].T_world_camera = result_.poses[i];
        return adjusted;
    }

    /// The landmarks that a frame between keyframes sees.
    [[nodiscard]] std::vector<Observation> look(std::size_t i, const Trajectories& trajectories,
                                                const LandmarkSearch& search) const {
        if (!frames_[i].tracked || std::binary_search(chosen_.begin(), chosen_.end(), i)) return {};
        const KeyframeImages frame = load_views(recording_, frames_, {i}, rolling_).front();
        return search.find_in(frame, trajectories.near(i, distance_));
    }

    /// All frames, by keyframes and landmarks. @param seen  landmarks, by each frame; of keyframes none
    void place_all(const Trajectories& trajectories, const Bundle& bundle,
                   const std::vector<std::vector<Observation>>& seen) {
        const std::vector<LookedFrame> adjusted = adjusted_frames();
        result_.poses.clear();
        result_.placed = 0;
        for (std::size_t i = 0; i < frames_.size(); ++i) {
            const Isometry3d expected = trajectories.pose(i);
            const auto readout = rolling_ ? readout_of(adjusted, i, result_.way, false) : std::nullopt;
            const auto placed = place(bundle, seen[i], readout.value_or(FrameReadout{}), expected);
            result_.poses.push_back(placed.value_or(expected));
            if (placed) ++result_.placed;
        }
    }

    /// The first frame stays where it is: there the world begins.
    void begin_where_it_began() {
        const Isometry3d back = tracked_.front().T_world_camera * result_.poses.front().inverse();
        for (std::size_t i = 0; i < frames_.size(); ++i) {
            result_.poses[i] = back * result_.poses[i];
            const double change = (result_.poses[i].translation() - tracked_[i].T_world_camera.translation()).norm();
            result_.mean_change_m += change / static_cast<double>(frames_.size());
            result_.largest_change_m = std::max(result_.largest_change_m, change);
        }
    }

    const Recording& recording_;
    const std::vector<LookedFrame>& tracked_;
    std::vector<LookedFrame> frames_;  ///< as they were tracked, or taken back from where they had been taken
    std::vector<bool> taken_in_;       ///< by frames
    const RunConfig& config_;
    const std::function<void(std::size_t, std::size_t)>& progress_;
    const std::function<bool()>& cancelled_;
    ViewDistance distance_;
    bool rolling_;
    std::vector<std::size_t> chosen_;  ///< keyframes, positions in frames_
    FinalAdjustment result_;
    std::size_t done_ = 0;  ///< steps of progress_
};

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
    return Adjuster(recording, frames, frames_taken_in(record), config, progress, cancelled).run();
}

}  // namespace posefusion
