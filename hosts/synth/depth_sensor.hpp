#pragma once
#include <cstdint>

#include "engine/core/depth_noise.hpp"
#include "engine/core/image.hpp"
#include "engine/core/intrinsics.hpp"
#include "hosts/synth/scene.hpp"

namespace posefusion::synth {

/// A structured-light sensor like the first Kinect, registered to the colour camera. Noise after Nguyen et al. (3DIMPVT
/// 2012), quantisation after Khoshelham and Elberink (Sensors 2012).
struct DepthSensorModel {
    float nearest = 0.4f, farthest = 5.0f;                ///< metres
    DepthNoise axial;                                     ///< along the optical axis: its sigma(z)
    float axial_correlation = 8;                          ///< pixels of a 640-pixel image
    float lateral_sigma = 0.5f, lateral_correlation = 4;  ///< pixels of a 640-pixel image
    float disparity_focal = 580, baseline = 0.075f;       ///< pixels, metres: disparity = focal * baseline / z
    float disparity_step = 0.125f;                        ///< pixels
    float grazing_none = 5, grazing_full = 13;            ///< degrees between ray and surface: no value, always a value
    float edge_jump = 0.04f, edge_dropout = 0.35f;        ///< relative step of depth, probability of no value beside it
    int reference_width = 640;                            ///< pixels; smaller images see coarser noise
};

/// The exact depth and labels at the pixel centres.
struct ExactView {
    DepthImage depth;   ///< metres, 0 = nothing
    LabelImage labels;  ///< 0 = room, i + 1 = person i
};

[[nodiscard]] ExactView look_exactly(const Scene& scene, const Crowd& crowd, const Intrinsics& camera,
                                     const Isometry3f& T_world_camera, int threads);

/// Simulates the sensor's measurement of an exact depth image.
[[nodiscard]] DepthImage measure_depth(const DepthSensorModel& model, const ExactView& exact, const Scene& scene,
                                       const Crowd& crowd, const Intrinsics& camera, const Isometry3f& T_world_camera,
                                       std::uint64_t seed, int threads);

}  // namespace posefusion::synth
