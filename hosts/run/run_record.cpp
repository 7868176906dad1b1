#include "hosts/run/run_record.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace posefusion {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr double kMostLost = 0.5;           // share of frames without a pose beyond which the result is useless
constexpr std::size_t kFewestToJudge = 10;  // frames; too few to judge below
constexpr double kCompiling =
    10;  // ratio to the usual time from which shaders were compiled in one of the first frames
constexpr std::size_t kFramesToStable = 60;  // by then a static surface has become stable

template <class Value>
StageSeries series(const std::string& name, const std::vector<FrameRecord>& frames, Value value) {
    StageSeries out{name, {}};
    for (const FrameRecord& frame : frames) out.milliseconds.push_back(value(frame));
    return out;
}

}  // namespace

void RunRecord::add(ScheduledFrame& frame, double interval_ms, bool as_sample) {
    const Segmentation& people = frame.people.segmentation;
    FrameRecord record;
    record.index = frame.input.index;
    record.stamp = frame.input.stamp;
    record.result = std::move(frame.result);
    record.people = people.people;
    record.carried = people.carried;
    record.read_ms = frame.read_ms;
    record.joints_ms = frame.people.joints_ms;
    record.segmentation_ms = frame.people.segmentation_ms;
    record.slam_ms = frame.slam_ms;
    record.latency_ms = frame.latency_ms;
    record.interval_ms = interval_ms;
    frames.push_back(std::move(record));
    if (as_sample) {
        samples.push_back({frame.input.index, frame.input.stamp, std::move(frame.input.color),
                           std::move(frame.people.segmentation.labels), frame.people.joints.value_or(People{})});
    }
}

std::size_t RunRecord::first_frame() const {
    const auto is_first = [](const FrameRecord& f) { return f.result.tracking == TrackingState::FirstFrame; };
    const auto last = std::find_if(frames.rbegin(), frames.rend(), is_first);
    return last == frames.rend() ? 0 : static_cast<std::size_t>(frames.rend() - last) - 1;
}

Trajectory RunRecord::trajectory() const {
    Trajectory poses;
    const std::size_t first = first_frame();
    for (std::size_t i = first; i < frames.size(); ++i) {
        const bool corrected = i - first < corrected_poses.size();
        poses.push_back({frames[i].stamp, corrected ? corrected_poses[i - first] : frames[i].result.T_world_camera});
    }
    return poses;
}

std::string RunRecord::fault() const {
    if (frames.empty()) return "";
    const FrameResult& last = frames.back().result;
    if (last.surfels == 0) {
        return "the map is empty: no depth between preprocess.depth_min and preprocess.depth_max; check depth_scale in "
               "the camera file";
    }
    const auto posed = std::count_if(frames.begin() + static_cast<std::ptrdiff_t>(first_frame()), frames.end(),
                                     [](const FrameRecord& f) { return has_pose(f.result.tracking); });
    const std::size_t without = frames.size() - static_cast<std::size_t>(posed);
    if (frames.size() >= kFewestToJudge &&
        static_cast<double>(without) > kMostLost * static_cast<double>(frames.size())) {
        return "the camera was lost in " + std::to_string(without) + " of " + std::to_string(frames.size()) +
               " frames, too many for a trajectory; look at the report for where, and at docs/tune.md for why";
    }
    if (last.stable_surfels == 0 && frames.size() >= kFramesToStable) {
        return "nothing in the map is stable after " + std::to_string(frames.size()) +
               " frames; check depth_scale in the camera file and that depth is registered to colour";
    }
    return "";
}

std::vector<LostInterval> RunRecord::lost_intervals() const {
    const auto tracked = [&](std::size_t i) { return has_pose(frames[i].result.tracking); };
    std::vector<LostInterval> intervals;
    for (std::size_t i = 0; i < frames.size(); ++i) {
        if (tracked(i)) continue;
        const std::size_t first = i;
        while (i + 1 < frames.size() && !tracked(i + 1)) ++i;
        intervals.push_back({first, i, i + 1 < frames.size()});
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
        poses.push_back({frame.stamp, frame.result.T_world_tracked, frame.result.T_world_camera});
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
