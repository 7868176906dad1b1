#include "hosts/run/first_look.hpp"

#include <algorithm>

#include "engine/core/motion_judge.hpp"
#include "hosts/pipeline/frame_scheduler.hpp"
#include "hosts/run/run_session.hpp"

namespace posefusion {
namespace {

/// 1 for a residual that there is not: a term of tracking that is off.
double ratio(double after, double before) { return before > 0 ? after / before : 1; }

}  // namespace

double agreement(const FirstLook& before, const FirstLook& after) {
    return ratio(after.icp_rmse_m, before.icp_rmse_m) * ratio(after.photometric_rmse, before.photometric_rmse);
}

std::size_t frames_to_look_at(const Recording& recording, const RunConfig& config) {
    if (recording.live()) return 0;
    const std::size_t wanted = config.max_frames > 0 ? static_cast<std::size_t>(config.max_frames) : recording.size();
    const std::size_t frames = std::min({recording.size(), wanted, FirstLookConfig::kFrames});
    return frames < FirstLookConfig::kFewestFrames ? 0 : frames;
}

RunConfig config_of_look(const RunConfig& config, int width) {
    RunConfig small = config;
    small.objects = false;
    small.scale = std::min(config.scale, FirstLookConfig::kWidth / static_cast<float>(width));
    small.no_loops = true;
    small.load_map.clear();
    small.localise_only = false;
    small.resume = false;
    small.checkpoint_every = 0;
    small.slam.pieces.begin_after = 0;
    small.slam.estimate_timing = true;
    return small;
}

FirstLook look_at(const std::filesystem::path& location, const RunConfig& config, std::size_t frames,
                  const std::function<void()>& frame_done, const std::function<bool()>& cancelled) {
    Recording recording(location, source_options(config));
    PoseFusion method(recording, config);
    FrameScheduler scheduler(recording, method);
    FirstLook seen;
    std::size_t tracked = 0;
    FrameScheduler::Observer observer;
    observer.cancelled = cancelled;
    observer.warning = [](const std::string&) {};  // the run says it
    observer.frame_done = [&](const ScheduledFrame& frame) {
        frame_done();
        const bool ok = frame.result.tracking == TrackingState::Ok;
        seen.frames.push_back({frame.input.index, frame.input.stamp, frame.input.depth_delay,
                               frame.result.T_world_camera, ok || frame.result.tracking == TrackingState::FirstFrame,
                               with_movers(frame.people.segmentation.labels, frame.result.movers)});
        if (!ok) return;
        ++tracked;
        seen.icp_rmse_m += static_cast<double>(frame.result.icp_rmse_m);
        seen.photometric_rmse += static_cast<double>(frame.result.photometric_rmse);
    };
    const PipelineOutcome outcome = scheduler.run(frames, Schedule::Pipelined, observer, Pace::EveryFrame);
    if (outcome.error) std::rethrow_exception(outcome.error);
    seen.cancelled = outcome.cancelled;
    seen.timing = method.engine().sensor_timing();
    const double n = std::max(1.0, static_cast<double>(tracked));
    seen.icp_rmse_m /= n;
    seen.photometric_rmse /= n;
    return seen;
}

}  // namespace posefusion
