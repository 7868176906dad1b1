#include "hosts/run/calibration_search.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "hosts/run/console.hpp"
#include "hosts/run/keyframe_choice.hpp"
#include "hosts/run/run_session.hpp"
#include "hosts/run/sensor_search.hpp"
#include "hosts/run/signals.hpp"

namespace posefusion {
namespace {

/// The recording's camera with what is believed about its images, which may be smaller than recorded.
Camera camera_of(const Camera& recorded, const Intrinsics& image, const Calibration& calibration) {
    Camera camera = recorded;
    const CameraParameters& p = calibration.believed;
    if (calibration.intrinsics) {
        const auto corrected = [](float recorded_value, double share) {
            return static_cast<float>(static_cast<double>(recorded_value) * share);
        };
        Intrinsics& K = camera.intrinsics;
        const double shrunk_u = static_cast<double>(image.fx / K.fx), shrunk_v = static_cast<double>(image.fy / K.fy);
        K.fx = corrected(K.fx, p(0) / calibration.given(0));
        K.fy = corrected(K.fy, p(1) / calibration.given(1));
        K.cx += static_cast<float>((p(2) - calibration.given(2)) / shrunk_u);
        K.cy += static_cast<float>((p(3) - calibration.given(3)) / shrunk_v);
    }
    if (calibration.deformation) {
        const DepthDeformation found = deformation_of(p);
        for (std::size_t i = 0; i < DepthDeformation::kNodes; ++i) camera.deformation.nodes[i] += found.nodes[i];
    }
    return camera;
}

/// In whole tenths of a millisecond. What was not known to roll still does not.
ShutterConfig shutter_of(const RowTimes& times, const ShutterConfig& known) {
    const auto milliseconds = [](double s, double least, double most) {
        return static_cast<float>(std::round(10 * std::clamp(1e3 * s, least, most)) / 10);
    };
    constexpr double kMostReadout = SensorSearchConfig::kMostReadout_ms, kMostDelay = SensorSearchConfig::kMostDelay_ms;
    ShutterConfig shutter = known;
    if (known.color_readout_ms > 0) shutter.color_readout_ms = milliseconds(times.color_readout, 0, kMostReadout);
    if (known.depth_readout_ms > 0) shutter.depth_readout_ms = milliseconds(times.depth_readout, 0, kMostReadout);
    shutter.depth_delay_ms = milliseconds(times.depth_delay, -kMostDelay, kMostDelay);
    return shutter;
}

}  // namespace

std::optional<FoundCalibration> look_for_calibration(const std::filesystem::path& recording, RunConfig& config,
                                                     FirstLook look) {
    Console console;
    const auto progress = [&](std::size_t done, std::size_t total) {
        console.progress(done, total, "looking at the calibration");
    };
    std::optional<FoundCalibration> found = find_calibration(recording, config, std::move(look), progress, interrupted);
    console.end_progress();
    if (!found || !found->camera) return found;
    config.calibrated = found->camera;
    config.slam.shutter = found->shutter;
    console.remark("calibration found and corrected: " + calibration_change(*found) +
                   " (off: --sensor-calibration given)");
    return found;
}

std::optional<FoundCalibration> find_calibration(const std::filesystem::path& location, const RunConfig& config,
                                                 FirstLook look,
                                                 const std::function<void(std::size_t, std::size_t)>& progress,
                                                 const std::function<bool()>& cancelled) {
    if (config.sensor_calibration == SensorCalibrationMode::Given || is_camera(location)) return std::nullopt;
    SourceOptions options = source_options(config);
    options.scale = 1;
    const Camera recorded = Recording(location, options).camera();
    options.scale = std::min(1.0f, CalibrationSearchConfig::kWidth / static_cast<float>(recorded.intrinsics.width));
    const Recording recording(location, options);
    const std::size_t frames = frames_to_look_at(recording, config);
    if (frames == 0) return std::nullopt;

    RunConfig small = config_of_look(config, recorded.intrinsics.width);
    small.slam.estimate_timing = false;
    std::size_t done = 0;
    const auto frame_done = [&] { progress(++done, 2 * frames); };
    const bool times_were_found = !look.frames.empty();  // else they are as given
    if (!times_were_found) look = look_at(location, small, frames, frame_done, cancelled);
    if (look.cancelled || look.frames.empty()) return std::nullopt;

    FoundCalibration found;
    found.image = recording.intrinsics();
    found.shutter = config.slam.shutter;
    const bool rolling = !config.slam.shutter.is_global();
    const std::optional<RowTimes> times = rolling ? std::optional(row_times(config.slam.shutter)) : std::nullopt;
    const std::vector<std::size_t> views =
        choose_views(look.frames, ViewDistance(recording, look.frames), rolling, CalibrationSearchConfig::kKeyframes);
    const std::vector<KeyframeImages> keyframes = load_views(recording, look.frames, views, rolling);
    Bundle bundle = find_landmarks(keyframes, recording.intrinsics(), config.slam.noise, times);
    if (rolling) found.way = choose_way(bundle, look.frames, views);
    found.calibration = calibrate(std::move(bundle), rolling && times_were_found);
    if (!found.calibration.found()) return found;
    small.calibrated = camera_of(recorded, found.image, found.calibration);
    if (found.calibration.times)
        found.shutter = small.slam.shutter =
            shutter_of(times_of(found.calibration.believed, times->stamp_row), config.slam.shutter);
    const FirstLook after = look_at(location, small, frames, frame_done, cancelled);
    if (after.cancelled) return std::nullopt;
    found.agreement = agreement(look, after);
    using C = CalibrationSearchConfig;
    const double worst = !rolling                     ? C::kWorstAgreement
                         : found.way == Way::Straight ? C::kWorstStraightAgreement
                                                      : C::kWorstRollingAgreement;
    if (found.agreement < worst)
        found.camera = small.calibrated;
    else
        found.shutter = config.slam.shutter;
    return found;
}

std::string calibration_change(const FoundCalibration& found) {
    const Calibration& c = found.calibration;
    std::string text;
    if (c.intrinsics)
        text = fmt::format("fx {:+.2f} %, fy {:+.2f} %, cx {:+.1f} px, cy {:+.1f} px",
                           100 * (c.believed(0) / c.given(0) - 1), 100 * (c.believed(1) / c.given(1) - 1),
                           c.believed(2) - c.given(2), c.believed(3) - c.given(3));
    if (c.deformation)
        text += fmt::format("{}depth at 2 m by up to {:.1f} cm", text.empty() ? "" : ", ",
                            100 * 4 * deformation_part(c.believed).cwiseAbs().maxCoeff());
    if (c.times)
        text += fmt::format("{}rows of colour in {:.1f} ms, of depth in {:.1f} ms", text.empty() ? "" : ", ",
                            found.shutter.color_readout_ms, found.shutter.depth_readout_ms);
    return text;
}

std::string calibration_text(const FoundCalibration& found) {
    const Calibration& c = found.calibration;
    std::string text = fmt::format("{} keyframes, {} landmarks seen {} times, images of {}x{}\n", c.keyframes,
                                   c.landmarks, c.observations, found.image.width, found.image.height);
    if (c.variance > 0)
        text +=
            fmt::format("errors        {:.2f} times as large as expected; held out {:.4f} as given, {:.4f} as found\n",
                        std::sqrt(c.variance), c.held_out_before, c.held_out);
    constexpr std::array<const char*, kIntrinsicParameters> kNames{"fx", "fy", "cx", "cy"};
    const auto sigma = [&](int i) { return std::sqrt(std::max(0.0, c.covariance(i, i))); };
    for (int i = 0; i < kIntrinsicParameters; ++i)
        text += fmt::format("{}            {:.2f} given, {:.2f} +- {:.2f} px found\n",
                            kNames[static_cast<std::size_t>(i)], c.given(i), c.estimate(i), sigma(i));
    text += "deformation of depth, 1/km\n";
    for (int i = kIntrinsicParameters; i < kIntrinsicParameters + kDeformationParameters; ++i) {
        const bool ends_row = (i - kIntrinsicParameters + 1) % DepthDeformation::kColumns == 0;
        text += fmt::format("  {:+.1f} +- {:.1f}{}", 1e3 * c.estimate(i), 1e3 * sigma(i), ends_row ? "\n" : "");
    }
    if (!found.shutter.is_global()) {
        constexpr std::array<const char*, kTimeParameters> kTimes{"delay of depth   ", "rows of depth in ",
                                                                  "rows of colour in"};
        for (int i = 0; i < kTimeParameters; ++i) {
            const int at = kCameraParameters - kTimeParameters + i;
            text += fmt::format("{} {:.1f} given, {:.1f} +- {:.1f} ms found\n", kTimes[static_cast<std::size_t>(i)],
                                1e3 * c.given(at), 1e3 * c.estimate(at), 1e3 * sigma(at));
        }
    }
    if (found.camera)
        text += "believed: " + calibration_change(found) + "\n";
    else if (c.found())
        text += fmt::format("not used: frames agree {:.3f} times as well with it\n", 1 / found.agreement);
    else
        text += "nothing certain: the calibration stays as given\n";
    return text;
}

}  // namespace posefusion
