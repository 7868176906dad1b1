#pragma once
#include "engine/core/depth_noise.hpp"
#include "engine/loops/loop_config.hpp"
#include "engine/map/map_config.hpp"
#include "engine/preprocess/preprocess_config.hpp"
#include "engine/tracking/tracking_config.hpp"

/// Every number of the dense SLAM engine, with unit, default and source. The shaders get them from here.
namespace posefusion {

struct SlamConfig {
    PreprocessConfig preprocess;
    DepthNoise noise;
    TrackingConfig tracking;
    MapConfig map;
    AlignmentConfig alignment;
    LoopConfig loops;
    DeformationConfig deformation;
    RelocalisationConfig relocalisation;
    bool localise_only = false;  ///< follow the camera in a restored map without changing it
    bool int64_atomics = true;   ///< use 64-bit atomics where the device has them (false: the two-pass fallback)
    bool validation = false;     ///< run with Vulkan's core and synchronization validation (slow; for tests)
};

}  // namespace posefusion
