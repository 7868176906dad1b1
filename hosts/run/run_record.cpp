#include "hosts/run/run_record.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "engine/core/number_text.hpp"
#include "engine/slam/map_piece.hpp"

namespace posefusion {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kMostLost = 0.5;           // share of frames without a pose beyond which the result is useless
constexpr std::size_t kFewestToJudge = 10;  // frames; fewer are no reason to fail
constexpr double kCompiling =
    10;  // ratio to the usual time from which shaders were compiled in one of the first frames
/// A camera that moves this far from a frame to the next, metres, and so many times faster than in the median of the
/// run, while the map is not older than so many frames, is in doubt.
constexpr double kLeap = 0.05, kLeapSpeed = 6;
constexpr std::size_t kYoung = 60;
constexpr std::size_t kFramesToStable = 60;  // by then a static surface has become stable

template <class Value>
StageSeries series(const std::string& name, const std::vector<FrameRecord>& frames, Value value) {
    StageSeries out{name, {}};
    for (const FrameRecord& frame : frames) out.milliseconds.push_back(value(frame));
    return out;
}

/// Blocks with a label: this many across.
constexpr int kBlocks = 40;
LabelImage blocks_with_labels(const LabelImage& labels) {
    if (std::all_of(labels.begin(), labels.end(), [](std::uint8_t label) { return label == 0; })) return {};
    const int across = std::min(kBlocks, labels.width());
    const int down = std::max(1, labels.height() * across / labels.width());
    LabelImage blocks(across, down);
    for (int v = 0; v < labels.height(); ++v)
        for (int u = 0; u < labels.width(); ++u)
            if (labels(u, v) != 0) blocks(u * across / labels.width(), v * down / labels.height()) = 1;
    return blocks;
}

}  // namespace

void RunRecord::add(ScheduledFrame& frame, double interval_ms, bool as_sample) {
    const Segmentation& people = frame.people.segmentation;
    FrameRecord record;
    record.index = frame.input.index;
    record.stamp = frame.input.stamp;
    record.result = std::move(frame.result);
    const LabelImage movers = std::exchange(record.result.movers, {});  // an image for each frame would be too much
    record.not_static = blocks_with_labels(with_movers(people.labels, movers));
    record.people = people.people;
    record.carried = people.carried;
    record.in_view = people_in_view(people.skeletons, frame.people.ids);
    record.read_ms = frame.read_ms;
    record.joints_ms = frame.people.joints_ms;
    record.segmentation_ms = frame.people.segmentation_ms;
    record.features_ms = frame.features_ms;
    record.slam_ms = frame.slam_ms;
    record.latency_ms = frame.latency_ms;
    record.interval_ms = interval_ms;
    frames.push_back(std::move(record));
    if (as_sample) {
        samples.push_back({frame.input.index, frame.input.stamp, std::move(frame.input.color),
                           with_movers(frame.people.segmentation.labels, movers),
                           frame.people.joints.value_or(People{})});
    }
}

void RunRecord::take_pieces(const Slam& slam, std::size_t frames_before) {
    pieces.clear();
    earlier_poses.clear();
    const auto take = [&](const std::vector<std::uint32_t>& numbers, const std::vector<Eigen::Isometry3d>& poses) {
        PieceRecord& piece = pieces.emplace_back();
        for (std::size_t i = 0; i < poses.size(); ++i) {
            if (numbers[i] < frames_before) {
                earlier_poses.push_back(poses[i]);
            } else if (numbers[i] - frames_before < frames.size()) {  // else an error came before it was recorded
                piece.frames.push_back(numbers[i] - frames_before);
                piece.poses.push_back(poses[i]);
            }
        }
    };
    take(slam.frames(), slam.trajectory());
    for (const MapPiece& piece : slam.other_pieces()) take(piece.frames, piece.trajectory);
    keyframes = slam.keyframes();
    if (pieces.size() > 1) {  // the last frame may be in another one
        surfels = slam.surfels(false).size();
        stable_surfels = slam.surfels(true).size();
    } else if (!frames.empty()) {
        surfels = frames.back().result.surfels;
        stable_surfels = frames.back().result.stable_surfels;
    }
}

Trajectory RunRecord::trajectory() const { return pieces.empty() ? Trajectory{} : trajectory(pieces.front()); }

Trajectory RunRecord::trajectory(const PieceRecord& piece) const {
    Trajectory poses;
    for (std::size_t i = 0; i < piece.frames.size(); ++i) {
        const FrameRecord& frame = frames[piece.frames[i]];
        if (has_pose(frame.result.tracking)) poses.push_back({frame.stamp, piece.poses[i]});
    }
    return poses;
}

Trajectory RunRecord::object_trajectory(const PieceRecord& piece, std::uint8_t label) const {
    Trajectory poses;
    for (std::size_t i = 0; i < piece.frames.size(); ++i) {
        const FrameRecord& frame = frames[piece.frames[i]];
        if (!has_pose(frame.result.tracking)) continue;
        for (const MovingObject& object : frame.result.objects)
            if (object.label == label) poses.push_back({frame.stamp, piece.poses[i] * object.T_camera_object});
    }
    return poses;
}

std::size_t RunRecord::tracked(const PieceRecord& piece) const {
    return static_cast<std::size_t>(std::count_if(piece.frames.begin(), piece.frames.end(), [&](std::size_t frame) {
        return has_pose(frames[frame].result.tracking);
    }));
}

std::string RunRecord::mostly_lost() const {
    const std::size_t with = pieces.empty() ? 0 : tracked(pieces.front()), without = frames.size() - with;
    if (static_cast<double>(without) <= kMostLost * static_cast<double>(frames.size())) return "";
    const std::string of_all = " of " + std::to_string(frames.size()) + " frames";
    const std::string what =
        pieces.size() > 1
            ? "the map is in " + std::to_string(pieces.size()) + " pieces that never met, and the main one has only " +
                  std::to_string(with) + of_all
            : "the camera was lost in " + std::to_string(without) + of_all + ", too many for a trajectory";
    return what + "; look at the report for where, and at docs/tune.md for why";
}

std::string RunRecord::leap_at_the_beginning() const {
    if (pieces.empty()) return "";
    struct Step {
        std::size_t frame;  ///< it ends there
        double metres, metres_per_second;
    };
    std::vector<Step> steps;
    const PieceRecord& piece = pieces.front();
    for (std::size_t i = 1; i < piece.frames.size(); ++i) {
        const std::size_t frame = piece.frames[i];
        const bool tracked =
            has_pose(frames[frame - 1].result.tracking) && frames[frame].result.tracking == TrackingState::Ok;
        const double seconds = to_seconds(frames[frame].stamp - frames[frame - 1].stamp);
        if (piece.frames[i - 1] + 1 != frame || !tracked || !(seconds > 0)) continue;
        const double metres = (piece.poses[i].translation() - piece.poses[i - 1].translation()).norm();
        steps.push_back({frame, metres, metres / seconds});
    }
    if (steps.size() < kFewestToJudge) return "";
    std::vector<double> speeds;
    for (const Step& step : steps) speeds.push_back(step.metres_per_second);
    const auto middle = speeds.begin() + static_cast<std::ptrdiff_t>(speeds.size() / 2);
    std::nth_element(speeds.begin(), middle, speeds.end());
    const auto leap = std::find_if(steps.begin(), steps.end(), [&](const Step& step) {
        return step.frame < kYoung && step.metres > kLeap && step.metres_per_second > kLeapSpeed * *middle;
    });
    if (leap == steps.end()) return "";
    return "the camera seems to have leapt by " + fixed_text(100 * leap->metres, 0) + " cm in frame " +
           std::to_string(frames[leap->frame].index) +
           ", many times its usual pace: perhaps something that filled the view moved away; if the trajectory is "
           "wrong, "
           "begin after it (--start)";
}

std::string RunRecord::fault() const {
    if (frames.empty()) return "";
    if (surfels == 0) {
        return "the map is empty: no depth between preprocess.depth_min and preprocess.depth_max; check depth_scale in "
               "the camera file";
    }
    if (const std::string lost = mostly_lost(); !lost.empty() && frames.size() >= kFewestToJudge) return lost;
    if (stable_surfels == 0 && frames.size() >= kFramesToStable) {
        return "nothing in the map is stable after " + std::to_string(frames.size()) +
               " frames; check depth_scale in the camera file and that depth is registered to colour";
    }
    return "";
}

std::vector<std::string> RunRecord::judge() {
    if (status != RunStatus::Finished) return {};
    const std::string useless = fault();
    if (!useless.empty()) {
        status = RunStatus::Failed;
        error = useless;
        warnings.insert(warnings.begin(), useless);
        return {};
    }
    std::vector<std::string> doubts{leap_at_the_beginning(), mostly_lost()};
    if (!frames.empty() && stable_surfels == 0)
        doubts.emplace_back(
            "nothing in the map is stable after so few frames, map.ply is empty: give more, or --all-surfels");
    std::erase(doubts, "");
    warnings.insert(warnings.begin(), doubts.begin(), doubts.end());
    return doubts;
}

std::vector<LostInterval> RunRecord::lost_intervals() const {
    std::vector<std::size_t> all(frames.size());
    std::iota(all.begin(), all.end(), std::size_t{0});
    return lost_intervals(all);
}

std::vector<LostInterval> RunRecord::lost_intervals(const std::vector<std::size_t>& among) const {
    const auto state = [&](std::size_t i) { return frames[among[i]].result.tracking; };
    std::vector<LostInterval> intervals;
    for (std::size_t i = 0; i < among.size(); ++i) {
        if (has_pose(state(i))) continue;
        const std::size_t first = i;
        while (i + 1 < among.size() && !has_pose(state(i + 1))) ++i;
        // the first frame of a new piece is where the camera was not found
        intervals.push_back({first, i, i + 1 < among.size() && state(i + 1) != TrackingState::FirstFrame});
    }
    return intervals;
}

std::size_t RunRecord::compiling_frames() const {
    if (frames.size() < kFewestToJudge) return 0;
    const double usual =
        summarize(series("", frames, [](const FrameRecord& f) { return f.slam_ms; }).milliseconds).median;
    std::size_t count = 0;
    while (count < kFirstRuns && frames[count].slam_ms > kCompiling * usual) ++count;
    return count;
}

std::vector<double> RunRecord::steady_times(std::vector<double> milliseconds) const {
    std::fill_n(milliseconds.begin(), std::min(compiling_frames(), milliseconds.size()), kNone);
    return milliseconds;
}

std::vector<double> RunRecord::intervals() const {
    return steady_times(series("", frames, [](const FrameRecord& f) { return f.interval_ms; }).milliseconds);
}

std::vector<StageSeries> RunRecord::host_stages() const {
    return {series("read", frames, [](const FrameRecord& f) { return f.read_ms; }),
            series("joints", frames, [](const FrameRecord& f) { return f.joints_ms.value_or(kNone); }),
            series("segmentation", frames, [](const FrameRecord& f) { return f.segmentation_ms.value_or(kNone); }),
            series("features", frames, [](const FrameRecord& f) { return f.features_ms.value_or(kNone); }),
            {"slam", steady_times(series("", frames, [](const FrameRecord& f) { return f.slam_ms; }).milliseconds)}};
}

std::vector<StageSeries> RunRecord::gpu_stages() const {
    std::vector<StageSeries> stages;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        auto position = stages.begin();  // position for a stage that has not been seen before
        for (const StageTime& time : frames[i].result.gpu_times) {
            auto stage = std::find_if(stages.begin(), stages.end(), [&](const auto& s) { return s.name == time.name; });
            if (stage == stages.end()) {
                stage = stages.insert(position, {time.name, std::vector<double>(frames.size(), kNone)});
            }
            double& sum = stage->milliseconds[i];
            sum = std::isnan(sum) ? time.milliseconds : sum + time.milliseconds;
            position = stage + 1;
        }
    }
    for (StageSeries& stage : stages) stage.milliseconds = steady_times(std::move(stage.milliseconds));
    return stages;
}

std::vector<MotionPrediction::Pose> tracked_poses(const std::vector<FrameRecord>& frames) {
    std::vector<MotionPrediction::Pose> poses;
    for (const FrameRecord& frame : frames)
        poses.push_back(
            {frame.stamp, frame.result.T_world_tracked, frame.result.T_world_camera, has_pose(frame.result.tracking)});
    return poses;
}

TimeSummary summarize(std::vector<double> milliseconds) {
    std::erase_if(milliseconds, [](double ms) { return std::isnan(ms); });
    if (milliseconds.empty()) return {0, kNone, kNone, kNone};
    std::sort(milliseconds.begin(), milliseconds.end());
    const std::size_t n = milliseconds.size();
    TimeSummary summary;
    summary.count = n;
    summary.median = (milliseconds[(n - 1) / 2] + milliseconds[n / 2]) / 2;
    summary.mean = std::accumulate(milliseconds.begin(), milliseconds.end(), 0.0) / static_cast<double>(n);
    summary.p95 = milliseconds[(95 * n + 99) / 100 - 1];  // nearest rank
    return summary;
}

}  // namespace posefusion
