#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "hosts/adjust/calibration.hpp"
#include "hosts/config/run_config.hpp"
#include "hosts/run/first_look.hpp"

namespace posefusion {

/// A look at the beginning of a recording before it is run: is its camera calibrated as its file says? Bundle
/// adjustment of keyframes, whose poses a first look gives, says so.
struct CalibrationSearchConfig {
    static constexpr std::size_t kKeyframes = 24;  ///< at most
    static constexpr float kWidth = 640;           ///< images are shrunk to about this
    /// What is right makes frames and model agree better; where exposure or people decide, at least not worse than
    /// this.
    static constexpr double kWorstAgreement = 1.01;
    /// Where the shutter rolls, how a hand trembles between two frames passes for focal length, too. Only what makes
    /// frames agree so much better is believed then: a wrong camera was seen to gain 9 %, the right one of a Kinect 33
    /// %. A camera that goes straight from frame to frame does not tremble.
    static constexpr double kWorstRollingAgreement = 0.85, kWorstStraightAgreement = 0.98;
};

struct FoundCalibration {
    Calibration calibration;       ///< in pixels of images of the size `image`
    Intrinsics image;              ///< of the images that it was found in
    std::optional<Camera> camera;  ///< of the recording, as it is believed; nullopt: as given
    ShutterConfig shutter;         ///< the same for its times; as given where there is no `camera`
    Way way = Way::Smooth;         ///< how the camera goes from frame to frame, where its shutter rolls
    double agreement = 1;          ///< of frames and model with it, compared to that without; see agreement()
};

/// Looks, shows progress, and takes over into `config` what was found.
/// @param look  at the frames, if there was one  @return as find_calibration()
[[nodiscard]] std::optional<FoundCalibration> look_for_calibration(const std::filesystem::path& recording,
                                                                   RunConfig& config, FirstLook look);

/// @param look  at the frames in which the times of rows and depth were found; none: they are as given
/// @param progress  frames done and frames in all
/// @return nullopt: not looked for, as the calibration is taken as given, or the recording is a camera, or too short;
/// or cancelled. Throws Error as RunSession does.
[[nodiscard]] std::optional<FoundCalibration> find_calibration(
    const std::filesystem::path& recording, const RunConfig& config, FirstLook look,
    const std::function<void(std::size_t, std::size_t)>& progress, const std::function<bool()>& cancelled);

/// What of the calibration was corrected, in a line.
[[nodiscard]] std::string calibration_change(const FoundCalibration& found);

/// What was found, line by line, with its uncertainty.
[[nodiscard]] std::string calibration_text(const FoundCalibration& found);

}  // namespace posefusion
