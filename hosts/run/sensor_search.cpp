#include "hosts/run/sensor_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hosts/run/console.hpp"
#include "hosts/run/run_session.hpp"
#include "hosts/run/signals.hpp"

namespace posefusion {
namespace {

constexpr double kMilliseconds = 1e3;

float tenths(double milliseconds) { return static_cast<float>(std::round(10 * milliseconds) / 10); }

}  // namespace

ShutterConfig believed(const SensorTiming::Estimate& estimate, const ShutterConfig& assumed) {
    const auto certain = [&](int i, double least_ms) {
        const double value = std::abs(estimate.times[i]);
        return kMilliseconds * value >= least_ms && value >= SensorSearchConfig::kLeastSigmas * estimate.sigma[i];
    };
    const auto readout = [&](int i) {
        return tenths(std::clamp(kMilliseconds * estimate.times[i], 0.0, SensorSearchConfig::kMostReadout_ms));
    };
    ShutterConfig shutter;
    shutter.stamp_row = assumed.stamp_row;
    if (certain(1, SensorSearchConfig::kLeastReadout_ms)) shutter.depth_readout_ms = readout(1);
    if (certain(2, SensorSearchConfig::kLeastReadout_ms)) shutter.color_readout_ms = readout(2);
    if (certain(0, SensorSearchConfig::kLeastDelay_ms))
        shutter.depth_delay_ms = tenths(std::clamp(
            kMilliseconds * estimate.times[0], -SensorSearchConfig::kMostDelay_ms, SensorSearchConfig::kMostDelay_ms));
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
    const Recording full(recording, source_options(config));
    const std::size_t frames = frames_to_look_at(full, config);
    if (frames == 0) return std::nullopt;

    RunConfig small = config_of_look(config, full.intrinsics().width);
    std::size_t done = 0;
    const auto frame_done = [&] { progress(++done, 2 * frames); };
    FoundTiming found;
    FirstLook before = look_at(recording, small, frames, frame_done, cancelled);
    if (before.cancelled) return std::nullopt;
    found.estimate = before.timing;
    const ShutterConfig first = believed(before.timing, config.slam.shutter);
    if (first.is_global()) {
        found.look = std::move(before);
        return found;
    }

    // Images corrected by what was found show what is left: the first look sees less than there is, as the poses that
    // it started from had taken part of it for motion.
    small.slam.shutter = first;
    FirstLook after = look_at(recording, small, frames, frame_done, cancelled);
    if (after.cancelled) return std::nullopt;
    found.icp_rmse_before_m = before.icp_rmse_m, found.photometric_rmse_before = before.photometric_rmse;
    found.icp_rmse_m = after.icp_rmse_m, found.photometric_rmse = after.photometric_rmse;
    if (!(agreement(before, after) < SensorSearchConfig::kWorstAgreement)) {
        found.look = std::move(before);
        return found;
    }
    found.look = std::move(after);
    found.estimate = found.look.timing;
    found.shutter = believed(found.estimate, config.slam.shutter);
    return found;
}

}  // namespace posefusion
