#pragma once
#include <filesystem>
#include <functional>
#include <optional>

#include "engine/slam/slam.hpp"
#include "hosts/config/run_config.hpp"
#include "hosts/run/first_look.hpp"

namespace posefusion {

/// A look at the beginning of a recording before it is run: does its camera have a rolling shutter, and is depth taken
/// at another time than colour? Small images are enough, and the same images always give the same answer.
struct SensorSearchConfig {
    // A shutter is believed to roll from this read-out time on, and depth to be late or early from this delay on, both
    // in ms and in standard deviations; less may be the work of exposure or calibration, and would change little.
    static constexpr double kLeastReadout_ms = 10, kLeastDelay_ms = 3;
    static constexpr double kLeastSigmas = 5;
    /// What is right makes frames and model agree better; where exposure or people decide, at least not worse than
    /// this.
    static constexpr double kWorstAgreement = 1.02;
    static constexpr double kMostReadout_ms = 33.3;  ///< the time between the frames of the cameras there are
    static constexpr double kMostDelay_ms = 20;      ///< images farther apart are no pair
};

struct FoundTiming {
    ShutterConfig shutter;  ///< what was found, in whole tenths of a millisecond; global: nothing was
    SensorTiming::Estimate estimate;
    FirstLook look;                                ///< at the frames, as corrected
    double icp_rmse_before_m = 0, icp_rmse_m = 0;  ///< means over the frames, without and with it
    double photometric_rmse_before = 0, photometric_rmse = 0;
};

/// Looks, shows progress, and takes over into `config` what was found. @return as find_sensor_timing()
[[nodiscard]] std::optional<FoundTiming> look_for_sensor_timing(const std::filesystem::path& recording,
                                                                RunConfig& config);

/// @param progress  frames done and frames in all
/// @return nullopt: not looked for, as the times are given, or the recording is a camera, or too short; or cancelled
/// Throws Error as RunSession does.
[[nodiscard]] std::optional<FoundTiming> find_sensor_timing(
    const std::filesystem::path& recording, const RunConfig& config,
    const std::function<void(std::size_t, std::size_t)>& progress, const std::function<bool()>& cancelled);

/// The times that an estimate is certain about; global if there are none.
[[nodiscard]] ShutterConfig believed(const SensorTiming::Estimate& estimate, const ShutterConfig& assumed);

}  // namespace posefusion
