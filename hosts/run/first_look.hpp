#pragma once
#include <cstddef>
#include <functional>
#include <vector>

#include "hosts/config/run_config.hpp"
#include "hosts/io/recording.hpp"
#include "hosts/pipeline/posefusion.hpp"

/// The beginning of a recording, run in small before the recording itself is run: what it says about the sensor.
namespace posefusion {

struct FirstLookConfig {
    static constexpr std::size_t kFrames = 150;
    static constexpr std::size_t kFewestFrames = 40;  ///< a shorter recording says too little
    static constexpr float kWidth = 320;              ///< images are shrunk to about this
};

/// A frame as it was tracked.
struct LookedFrame {
    std::size_t index = 0;  ///< in the recording
    Stamp stamp{}, depth_delay{};
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    bool tracked = false;
    LabelImage labels;  ///< people and movers, in the size of the look; empty: none
};

/// What one pass over the frames says.
struct FirstLook {
    std::vector<LookedFrame> frames;
    SensorTiming::Estimate timing;
    double icp_rmse_m = 0, photometric_rmse = 0;  ///< means over the tracked frames
    bool cancelled = false;
};

/// How much better two looks agree with their maps: the product of the ratios of their errors, `after` to `before`.
[[nodiscard]] double agreement(const FirstLook& before, const FirstLook& after);

/// How many frames there are to look at; 0: none, as it is a camera, or too short.
[[nodiscard]] std::size_t frames_to_look_at(const Recording& recording, const RunConfig& config);

/// The configuration of the run, but small, short and without results. @param width  of the images of the run
[[nodiscard]] RunConfig config_of_look(const RunConfig& config, int width);

/// Throws Error as RunSession does.
[[nodiscard]] FirstLook look_at(const std::filesystem::path& recording, const RunConfig& config, std::size_t frames,
                                const std::function<void()>& frame_done, const std::function<bool()>& cancelled);

}  // namespace posefusion
