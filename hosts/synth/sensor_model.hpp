#pragma once
#include <limits>
#include <string_view>
#include <vector>

#include "engine/core/depth_noise.hpp"
#include "engine/preprocess/shutter_config.hpp"
#include "hosts/io/lens.hpp"

/// What kinds of RGB-D cameras do to the scene they see. A kind is a value: everything it does is a number here, and
/// zero (or what the default says) where it does not do it. Errors that differ from unit to unit are given as
/// tolerances, see SensorUnit.
namespace posefusion::synth {

/// How a depth image is measured, registered to the colour camera. The default is a structured-light sensor like the
/// first Kinect: noise after Nguyen et al. (3DIMPVT 2012), quantisation after Khoshelham and Elberink (Sensors 2012).
struct DepthSensorModel {
    float nearest = 0.4f, farthest = 5.0f;                ///< metres
    DepthNoise axial;                                     ///< along the optical axis: its sigma(z)
    float axial_correlation = 8;                          ///< pixels of a 640-pixel image
    float lateral_sigma = 0.5f, lateral_correlation = 4;  ///< pixels of a 640-pixel image
    float disparity_focal = 580, baseline = 0.075f;       ///< pixels, metres: disparity = focal * baseline / z
    float disparity_step = 0.125f;                        ///< pixels; 0: depth is not quantised
    float grazing_none = 5, grazing_full = 13;            ///< degrees between ray and surface: no value, always a value
    float edge_jump = 0.04f, edge_dropout = 0.35f;        ///< relative step of depth, probability of no value beside it
    int reference_width = 640;                            ///< pixels; smaller images see coarser noise

    /// Depth pixels across the image; 0: as many as colour has. Where there are fewer, pixels of colour share one.
    int columns = 0;

    // Stereo: where the image is even there is little to match.
    float weak_contrast = 0;  ///< grey levels of 255 within the window of matching: less is weak; 0: no matter
    float weak_noise = 1;     ///< axial noise without any contrast, as a multiple
    /// There are holes where a smooth random field exceeds this many standard deviations: where there is contrast, and
    /// without any.
    float hole_sigmas = std::numeric_limits<float>::infinity(), weak_hole_sigmas = hole_sigmas;
    float hole_size = 16;  ///< pixels of a 640-pixel image over which the field varies

    // Time of flight: what arrives at a pixel is the mean over all ways that light took.
    float aperture = 0;         ///< depth pixels that a pixel mixes: at edges its value hangs in the air between
    float indirect_albedo = 0;  ///< of surfaces in the infra-red: light by way of another surface; 0: none
};

/// How the exposure follows the view. All in stops (EV) of linear light: +1 doubles it.
struct ExposureControl {
    float follow = 0;    ///< share of a change of the view's brightness that is made up for in the end; 0: fixed
    float lag_s = 0.4f;  ///< seconds in which 63 % of it is done
    float range_ev = 2;  ///< darker or brighter than the first view by this at most
    float wander_ev = 0, wander_s = 3.3f;    ///< the exposure is never quite steady: amplitude, period in seconds
    float balance_ev = 0, balance_s = 4.8f;  ///< white balance: red rises while blue falls; amplitude, period
    float vignetting_ev = 0;                 ///< darkness of the corners, growing with the square of the radius

    [[nodiscard]] bool steady() const { return follow == 0 && wander_ev == 0 && balance_ev == 0 && vignetting_ev == 0; }
};

/// Errors of a factory calibration; each unit draws its own, evenly up to this much either way.
struct CalibrationTolerance {
    float focal = 0;      ///< relative, fx and fy each
    float principal = 0;  ///< pixels of a 640-pixel image, cx and cy each
    float lens = 0;       ///< relative, of all coefficients together
};

/// Smooth errors of depth; each unit draws its own. See DepthDistortion.
struct DistortionTolerance {
    float corner_least = 0, corner_most = 0;  ///< 1/metre, either sign
    float tilt = 0;                           ///< 1/metre, up to this either way
};

struct SensorModel {
    const char* name = "clean";
    const char* summary = "structured-light depth noise, a perfect calibration and a global shutter";
    /// depth_delay_ms is what no stamp tells. The stamp refers to a row as it says.
    ShutterConfig shutter;
    float stamped_delay_ms = 0;   ///< depth is taken so much later than colour, and its stamp says so
    float stamped_wander_ms = 0;  ///< the two streams drift against each other by as much, within half a minute
    ExposureControl exposure;
    LensCoefficients lens{};  ///< of colour, and of depth, which is registered to it
    CalibrationTolerance calibration;
    DistortionTolerance depth_distortion;
    DepthSensorModel depth;

    /// Whether it errs in nothing but noise: the camera file is exact, and a frame is of one instant.
    [[nodiscard]] bool perfect() const {
        return instantaneous() && lens == LensCoefficients{} && calibration.focal == 0 && calibration.principal == 0 &&
               depth_distortion.corner_most == 0 && depth_distortion.tilt == 0 && exposure.steady();
    }
    /// Whether all pixels of a frame are of one instant.
    [[nodiscard]] bool instantaneous() const {
        return shutter.is_global() && stamped_delay_ms == 0 && stamped_wander_ms == 0;
    }
};

/// All kinds there are: clean, kinect, realsense, tof, hardened. Their names are those of the command line.
[[nodiscard]] const std::vector<SensorModel>& sensor_models();
/// Throws Error when there is none of that name.
[[nodiscard]] const SensorModel& sensor_model(std::string_view name);

}  // namespace posefusion::synth
