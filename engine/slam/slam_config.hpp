#pragma once
#include <cstdint>

#include "engine/core/depth_noise.hpp"
#include "engine/loops/loop_config.hpp"
#include "engine/map/map_config.hpp"
#include "engine/preprocess/preprocess_config.hpp"
#include "engine/preprocess/shutter_config.hpp"
#include "engine/tracking/tracking_config.hpp"

/// The configuration of the dense SLAM engine: every value with unit, default and source. The shaders get them from
/// here.
namespace posefusion {

/// When the map is started again after a bad beginning: a person or a hand filled the view of the first frames and has
/// left, so that nothing in view is part of the map and place recognition cannot help. Own values.
struct StartConfig {
    /// Consecutive failed frames until the map is started again ...
    static constexpr int kPatience = 5;
    /// ... while it holds fewer stable surfels than this per pixel of an image ...
    static constexpr float kMinStable = 0.05f;
    /// ... or was tracked in fewer frames than this and for fewer than it has now been lost.
    static constexpr std::uint32_t kMaxFrames = 60;
    /// Without a failure, too: in the first frames, while it holds so few, and this share of the surfels in view is
    /// seen through: tracking followed what then moved away. When something that filled the view slides out of it
    /// within 1 to 12 frames it is 0.15 to 0.4; of good beginnings, with people and with big steps, up to 0.015, with a
    /// camera that is rolled quickly 0.07. Later, the latter reaches 0.3 while few surfels are stable.
    static constexpr float kSeenThrough = 0.1f;
    static constexpr std::uint32_t kMaxSeenThroughFrames = 30;
    /// Least share of pixels with static depth: a view with less would be no better beginning.
    static constexpr float kMinView = 0.1f;
};

/// When a new piece of map begins, and when two pieces become one (engine/slam/map_piece.hpp). Ours.
struct PieceConfig {
    int begin_after = 30;  ///< frames without tracking until a new piece begins; 0: never
    /// A keyframe that did not fit is not tried again for this many frames.
    static constexpr std::uint32_t kRetryAfter = 20;
    /// Of live and model intensities: more than for loops (AlignmentConfig), which drift keeps from going far astray.
    static constexpr float kMinCorrelation = 0.95f;
    /// Frames between two that have to agree on where the pieces are to each other ...
    static constexpr std::uint32_t kConfirmAfter = 5;
    /// ... to this much, metres and degrees: what alignment and tracking in between can be wrong by.
    static constexpr double kMaxDistance = 0.05;
    static constexpr double kMaxAngleDeg = 2;
};

struct SlamConfig {
    ShutterConfig shutter;
    PreprocessConfig preprocess;
    DepthNoise noise;
    TrackingConfig tracking;
    MapConfig map;
    AlignmentConfig alignment;
    LoopConfig loops;
    DeformationConfig deformation;
    RelocalisationConfig relocalisation;
    PieceConfig pieces;
    bool localise_only = false;    ///< track the camera in a restored map without changing it
    bool estimate_timing = false;  ///< for Slam::sensor_timing(); costs time in every frame
    bool int64_atomics = true;     ///< use 64-bit atomics where the device has them (false: the two-pass fallback)
    bool validation = false;       ///< run with Vulkan's core and synchronization validation (slow; for tests)
};

}  // namespace posefusion
