#include <fmt/format.h>

#include <string>
#include <utility>

#include "hosts/cli/commands.hpp"
#include "hosts/run/calibration_search.hpp"
#include "hosts/run/run_session.hpp"
#include "hosts/run/sensor_search.hpp"
#include "hosts/run/signals.hpp"

namespace posefusion {

int calibrate_command(const std::filesystem::path& recording, RunConfig& config, const std::filesystem::path& out) {
    config.sensor_calibration = SensorCalibrationMode::Auto;
    std::optional<FoundTiming> timing = look_for_sensor_timing(recording, config);
    const auto found = look_for_calibration(recording, config, timing ? std::move(timing->look) : FirstLook{});
    if (interrupted()) return kExitInterrupted;
    if (!found) {
        fmt::print("nothing is said about the calibration: that takes a recording of at least {} frames, no camera\n",
                   FirstLookConfig::kFewestFrames);
        return kExitOk;
    }
    fmt::print("{}", calibration_text(*found));
    if (!found->camera || out.empty()) return kExitOk;
    write_camera_file(out, *found->camera);
    fmt::print("written to {}\n", out.string());
    return kExitOk;
}

}  // namespace posefusion
