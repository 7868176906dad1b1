#include "hosts/run/sensor_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hosts/pipeline/frame_scheduler.hpp"
#include "hosts/run/console.hpp"
#include "hosts/run/run_session.hpp"
#include "hosts/run/signals.hpp"

namespace posefusion {
namespace {

constexpr double kMilliseconds = 1e3;
using Search = SensorSearchConfig;

/// What one pass over the frames says.
struct Look {
    SensorTiming::Estimate estimate;
    double icp_rmse_m = 0, photometric_rmse = 0;  // means
    bool cancelled = false;
};

Look look(Recording& recording, const RunConfig& config, std::size_t frames, const std::function<void()>& frame_done,
          const std::function<bool()>& cancelled) {
    PoseFusion method(recording, config);
    FrameScheduler scheduler(recording, method);
    Look seen;
    std::size_t tracked = 0;
    FrameScheduler::Observer observer;
    observer.cancelled = cancelled;
    observer.warning = [](const std::string&) {};  // the run says it
    observer.frame_done = [&](const ScheduledFrame& frame) {
        frame_done();
        if (frame.result.tracking != TrackingState::Ok) return;
        ++tracked;
        seen.icp_rmse_m += static_cast<double>(frame.result.icp_rmse_m);
        seen.photometric_rmse += static_cast<double>(frame.result.photometric_rmse);
    };
    const PipelineOutcome outcome = scheduler.run(frames, Schedule::Pipelined, observer, Pace::EveryFrame);
    if (outcome.error) std::rethrow_exception(outcome.error);
    seen.cancelled = outcome.cancelled;
    seen.estimate = method.engine().sensor_timing();
    const double n = std::max(1.0, static_cast<double>(tracked));
    seen.icp_rmse_m /= n;
    seen.photometric_rmse /= n;
    return seen;
}

/// The run, but small, short and without results.
RunConfig config_of_search(const RunConfig& config, int width) {
    RunConfig small = config;
    small.scale = std::min(config.scale, Search::kWidth / static_cast<float>(width));
    small.no_loops = true;
    small.load_map.clear();
    small.localise_only = false;
    small.resume = false;
    small.checkpoint_every = 0;
    small.slam.pieces.begin_after = 0;
    small.slam.estimate_timing = true;
    return small;
}

/// 1 for a residual that there is not: a term of tracking that is off.
double ratio(double after, double before) { return before > 0 ? after / before : 1; }

float tenths(double milliseconds) { return static_cast<float>(std::round(10 * milliseconds) / 10); }

}  // namespace

ShutterConfig believed(const SensorTiming::Estimate& estimate, const ShutterConfig& assumed) {
    const auto certain = [&](int i, double least_ms) {
        const double value = std::abs(estimate.times[i]);
        return kMilliseconds * value >= least_ms && value >= Search::kLeastSigmas * estimate.sigma[i];
    };
    const auto readout = [&](int i) {
        return tenths(std::clamp(kMilliseconds * estimate.times[i], 0.0, Search::kMostReadout_ms));
    };
    ShutterConfig shutter;
    shutter.stamp_row = assumed.stamp_row;
    if (certain(1, Search::kLeastReadout_ms)) shutter.depth_readout_ms = readout(1);
    if (certain(2, Search::kLeastReadout_ms)) shutter.color_readout_ms = readout(2);
    if (certain(0, Search::kLeastDelay_ms))
        shutter.depth_delay_ms =
            tenths(std::clamp(kMilliseconds * estimate.times[0], -Search::kMostDelay_ms, Search::kMostDelay_ms));
    return shutter;
}

std::optional<FoundTiming> look_for_sensor_timing(const std::filesystem::path& recording, RunConfig& config) {
    Console console;
    const auto progress = [&](std::size_t done, std::size_t total) {
        console.progress(done, total, "looking for a rolling shutter");
    };
    std::optional<FoundTiming> found = find_sensor_timing(recording, config, progress, interrupted);
    console.end_progress();
    if (!found || found->shutter.is_global()) return found;
    config.slam.shutter = found->shutter;
    const ShutterConfig& shutter = found->shutter;
    std::string text = fmt::format(
        "rolling shutter found and corrected: rows of colour are read within {} ms, those of depth within {} ms",
        shutter.color_readout_ms, shutter.depth_readout_ms);
    if (shutter.depth_delay_ms != 0)
        text += fmt::format("; depth is taken {} ms {} than its stamp says, compared to colour",
                            std::abs(shutter.depth_delay_ms), shutter.depth_delay_ms < 0 ? "earlier" : "later");
    console.remark(text + " (off: --sensor-timing given)");
    return found;
}

std::optional<FoundTiming> find_sensor_timing(const std::filesystem::path& recording, const RunConfig& config,
                                              const std::function<void(std::size_t, std::size_t)>& progress,
                                              const std::function<bool()>& cancelled) {
    if (config.sensor_timing == SensorTimingMode::Given || !config.slam.shutter.is_global()) return std::nullopt;
    if (is_camera(recording)) return std::nullopt;
    Recording full(recording, source_options(config));
    const std::size_t wanted = config.max_frames > 0 ? static_cast<std::size_t>(config.max_frames) : full.size();
    const std::size_t frames = std::min({full.size(), wanted, Search::kFrames});
    if (full.live() || frames < Search::kFewestFrames) return std::nullopt;

    RunConfig small = config_of_search(config, full.intrinsics().width);
    Recording frames_of_search(recording, source_options(small));
    std::size_t done = 0;
    const auto frame_done = [&] { progress(++done, 2 * frames); };
    FoundTiming found;
    const Look before = look(frames_of_search, small, frames, frame_done, cancelled);
    if (before.cancelled) return std::nullopt;
    found.estimate = before.estimate;
    const ShutterConfig first = believed(before.estimate, config.slam.shutter);
    if (first.is_global()) return found;

    // Images corrected by what was found show what is left: the first look sees less than there is, as the poses that
    // it started from had taken part of it for motion.
    small.slam.shutter = first;
    const Look after = look(frames_of_search, small, frames, frame_done, cancelled);
    if (after.cancelled) return std::nullopt;
    found.icp_rmse_before_m = before.icp_rmse_m, found.photometric_rmse_before = before.photometric_rmse;
    found.icp_rmse_m = after.icp_rmse_m, found.photometric_rmse = after.photometric_rmse;
    const double agreement =
        ratio(after.icp_rmse_m, before.icp_rmse_m) * ratio(after.photometric_rmse, before.photometric_rmse);
    if (!(agreement < Search::kWorstAgreement)) return found;
    found.estimate = after.estimate;
    found.shutter = believed(after.estimate, config.slam.shutter);
    return found;
}

}  // namespace posefusion
