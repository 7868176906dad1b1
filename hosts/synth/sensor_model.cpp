#include "hosts/synth/sensor_model.hpp"

#include <string>

#include "engine/core/error.hpp"

namespace posefusion::synth {
namespace {

/// Auto exposure as cheap cameras do it: most of a change is made up for within a second. What remains of vignetting
/// after the camera's own correction is a third of a stop.
ExposureControl automatic() {
    ExposureControl control;
    control.follow = 0.7f;
    control.balance_ev = 0.05f;
    control.vignetting_ev = 0.3f;
    return control;
}

/// The first Kinect, Xtion, PrimeSense. Both sensors roll: Ringaby and Forssen (ICCV 2011) measured 26 and 30 ms. The
/// streams run freely against each other: in the TUM RGB-D benchmark the stamps differ by up to 20 ms. Lens: freiburg1
/// of that benchmark, whose calibration differs from the factory's by some tenths of a per cent and some pixels. Depth
/// distortion: Herrera, Kannala and Heikkila (PAMI 2012); at 4 m up to 2 cm.
SensorModel kinect() {
    SensorModel s;
    s.name = "kinect";
    s.summary = "structured light: both shutters roll, streams drift, lens of the first Kinect";
    s.shutter.color_readout_ms = 26;
    s.shutter.depth_readout_ms = 30;
    s.stamped_delay_ms = 4;
    s.stamped_wander_ms = 10;
    s.exposure = automatic();
    s.lens = {0.2624f, -0.9531f, -0.0054f, 0.0026f, 1.1633f};
    s.calibration = {.focal = 0.004f, .principal = 1.5f, .lens = 0.05f};
    s.depth_distortion = {.corner_least = 0.001f, .corner_most = 0.003f, .tilt = 0.001f};
    return s;
}

/// RealSense D435: stereo of global-shutter imagers 50 mm apart (focal length 425 pixels at 848 x 480), with a
/// projected pattern; matching errs by 0.08 pixels RMS (Intel's guide to tuning), in steps of 1/32; error = pixels z^2
/// / (focal baseline). The colour camera rolls, and its stamp is the driver's.
SensorModel realsense() {
    SensorModel s;
    s.name = "realsense";
    s.summary = "stereo: noise grows with distance and on even surfaces, sparse holes; colour rolls";
    s.shutter.color_readout_ms = 20;
    s.shutter.depth_delay_ms = -6;
    s.stamped_delay_ms = 5;
    s.exposure = automatic();
    s.calibration = {.focal = 0.003f, .principal = 1.5f};
    s.depth_distortion = {.corner_least = 0.001f, .corner_most = 0.003f, .tilt = 0.001f};
    DepthSensorModel& d = s.depth;
    d.nearest = 0.28f, d.farthest = 6;
    d.disparity_focal = 425, d.baseline = 0.05f, d.disparity_step = 1.0f / 32;
    d.axial.a = 0.0005f, d.axial.b = 0.08f / (d.disparity_focal * d.baseline), d.axial.c = 0;
    d.axial_correlation = 6;
    d.weak_contrast = 6, d.weak_noise = 2;
    d.hole_sigmas = 2.5f, d.weak_hole_sigmas = 1;  // the pattern keeps most of a bare wall
    d.edge_dropout = 0.5f;
    return s;
}

/// Kinect v2 and its like: 512 pixels across, no shutter in depth, 0.5 to 4.5 m, noise of some millimetres (Lachat et
/// al., Remote Sensing 2015), values in the air at edges, corners that recede because light reaches them by way of the
/// other wall; the colour camera rolls.
SensorModel tof() {
    SensorModel s;
    s.name = "tof";
    s.summary = "time of flight: low noise, flying pixels, rounded corners, coarse pixels; colour rolls";
    s.shutter.color_readout_ms = 25;
    s.stamped_delay_ms = -6;
    s.exposure = automatic();
    s.lens = {0.05f, -0.06f, 0.0005f, -0.0003f, 0};
    s.calibration = {.focal = 0.002f, .principal = 1, .lens = 0.05f};
    s.depth_distortion = {.corner_least = 0.0005f, .corner_most = 0.0015f, .tilt = 0.0005f};
    DepthSensorModel& d = s.depth;
    d.nearest = 0.5f, d.farthest = 4.5f;
    d.columns = 512;
    d.baseline = 0, d.disparity_step = 0;
    d.axial.a = 0.0012f, d.axial.b = 0.0003f, d.axial.c = 0;
    d.axial_correlation = 1, d.lateral_sigma = 0;
    d.grazing_none = 2, d.grazing_full = 6;
    d.edge_dropout = 0.2f;
    d.aperture = 1;
    d.indirect_albedo = 0.2f;
    return s;
}

/// Not one camera but the worst of several at once, as the engine's aims for real cameras are measured with: 30 ms
/// of shutter in both images, depth 12 ms late (stamped), an unsteady exposure (about a quarter of the grey level) with
/// vignetting of a quarter in the corners, focal lengths off by up to 0.8 % and the principal point by 3 pixels, depth
/// distorted by up to 0.8 % per metre in the corners.
SensorModel hardened() {
    SensorModel s;
    s.name = "hardened";
    s.summary = "as clean, with strong effects of shutter, delay, exposure, calibration and distortion";
    s.shutter.color_readout_ms = s.shutter.depth_readout_ms = 30;
    s.stamped_delay_ms = 12;
    s.exposure = automatic();
    s.exposure.wander_ev = 0.9f;
    s.exposure.balance_ev = 0.15f;
    s.exposure.vignetting_ev = 0.9f;
    s.calibration = {.focal = 0.008f, .principal = 3};
    s.depth_distortion = {.corner_least = 0.003f, .corner_most = 0.008f, .tilt = 0.003f};
    return s;
}

}  // namespace

const std::vector<SensorModel>& sensor_models() {
    static const std::vector<SensorModel> models{SensorModel{}, kinect(), realsense(), tof(), hardened()};
    return models;
}

const SensorModel& sensor_model(std::string_view name) {
    for (const SensorModel& model : sensor_models())
        if (model.name == name) return model;
    throw Error("synth: there is no sensor " + std::string(name) + "; use clean, kinect, realsense, tof or hardened");
}

}  // namespace posefusion::synth
