#pragma once
#include "engine/core/depth_noise.hpp"
#include "engine/loops/deformation_graph.hpp"
/// Every number of the dense SLAM engine, with unit, default and source. The shaders get them from here.
namespace posefusion {

struct PreprocessConfig {
    float depth_min = 0.3f;        ///< nearest depth used, metres
    float depth_max = 5.0f;        ///< farthest depth used, metres
    int bilateral_radius = 2;      ///< window radius, pixels
    float bilateral_space = 1.5f;  ///< standard deviation, pixels
    float bilateral_range = 3.0f;  ///< standard deviation, in standard deviations of the depth noise at that depth
    int normal_radius = 3;         ///< window radius of the plane fit, pixels at half resolution
    int mask_dilation = 4;         ///< person masks grow by this before tracking and fusion, pixels at 640 wide
};

struct TrackingConfig {
    int iterations[3] = {10, 5, 4};  ///< most Gauss-Newton steps at full, half and quarter resolution
    int full_resolution_step = 2;    ///< at full resolution every 2nd pixel (chequerboard) or every pixel (1) is used
    int so3_iterations = 10;         ///< most steps of the rotation-only pre-alignment; 0 turns it off
    bool icp = true;                 ///< geometric term on
    bool photometric = true;         ///< photometric term on
    float icp_max_distance = 0.10f;  ///< between associated points, metres
    /// Between associated normals, degrees: those of one surface agree this well in spite of noise, across an edge not.
    static constexpr float kIcpMaxAngleDeg = 30.0f;
    float icp_robust = 2.0f;          ///< Cauchy scale of the geometric residual, standard deviations
    float photometric_weight = 8.0f;  ///< of the photometric term; depth noise is correlated over several pixels, so
                                      ///< that a depth pixel tells less than its variance says
    float photometric_robust = 2.0f;  ///< Cauchy scale of the photometric residual, standard deviations
    float min_gradient = 0.01f;  ///< pixels with less texture have no photometric residual, intensity (0..1) per pixel
    float converged_translation = 1e-4f;  ///< a level ends when a step moves less, metres ...
    float converged_rotation = 5e-5f;     ///< ... and rotates less, radians
    float min_inlier_ratio =
        0.35f;                   ///< of the live pixels with static depth; fewer: tracking has failed, the pose is held
    float max_icp_rmse = 0.06f;  ///< RMS point-to-plane residual; more: tracking has failed, metres
    float max_translation_sigma =
        0.02f;  ///< standard deviation of the pose along an axis; more: tracking has failed, metres
    float max_rotation_sigma = 0.02f;  ///< likewise about an axis, radians
    float max_translation = 0.3f;      ///< metres per frame; more is implausible: tracking has failed
    float max_rotation_deg = 30.0f;    ///< degrees per frame, likewise
};

struct MapConfig {
    int index_map_scale = 2;          ///< cells per pixel and axis: 2 = 4x super-sampled
    float association_depth = 0.05f;  ///< between a pixel and its surfel along the ray, metres (ElasticFusion) ...
    float association_sigmas = 3.0f;  ///< ... or so many standard deviations of the depth noise, whichever is more
    /// Between the normals of a pixel and its surfel, degrees; as TrackingConfig::kIcpMaxAngleDeg.
    static constexpr float kAssociationAngleDeg = 30.0f;
    float stable_confidence = 10.0f;  ///< a surfel is stable from this confidence on (ElasticFusion)
    float predict_confidence = 1.5f;  ///< surfels below this are not part of the predicted model
    float max_weight = 100.0f;        ///< of a surfel's running means, observations at 1 m
    int unstable_timeout = 20;        ///< unstable surfels not seen for so many frames are removed (ElasticFusion)
    float free_space_margin = 0.04f;  ///< static depth behind a surfel by this much proves it is not there, metres ...
    float free_space_sigmas = 4.0f;   ///< ... or by so many standard deviations, whichever is more
    float free_space_decay = 0.6f;    ///< factor on the confidence of such a surfel, per frame
    float duplicate_spacing =
        0.5f;  ///< of two stable surfels of one surface, nearer than so many radii, one goes; 0: both stay ...
    int duplicate_age = 100;  ///< ... if they are of different visits: created so many frames apart
    float duplicate_depth =
        0.005f;  ///< two surfels are of one surface if less than this lies between them, metres along the normal ...
    float duplicate_sigmas = 2.0f;         ///< ... or so many standard deviations, whichever is more
    float speed_scale = 0.05f;             ///< metres or radians per frame from which on fusion weighs half
    unsigned initial_capacity = 1u << 20;  ///< surfels
    unsigned max_capacity = 8u << 20;      ///< surfels; a map that needs more ends the run with an error that says so
};

/// Place recognition. Numbers from ElasticFusion where not said otherwise.
struct FernConfig {
    int ferns = 500;    ///< comparisons a view is coded by
    unsigned seed = 1;  ///< of the random ferns; the same seed gives the same results
    /// Views are coded at 1 / kShrink of the image size: small enough that noise and texture do not decide.
    static constexpr int kShrink = 8;
    float keyframe_dissimilarity =
        0.3f;  ///< a view that differs from all keyframes in more than this share of its ferns is a new one
    float query_similarity =
        0.5f;  ///< least share of equal ferns of a proposal (ours: proposals are verified, but not for free)
    /// Share of the ferns that must have depth: a view with less (a person in front of the camera) would look like any
    /// other of its kind.
    static constexpr float kMinGood = 0.3f;
};

/// When is a live image the same place as the model it was aligned to? Used for loops and for relocalisation.
struct AlignmentConfig {
    /// The first, rough alignment starts from a pose with drift or from a keyframe's: wider gates than in tracking, for
    /// associated points (metres) and their normals (degrees).
    static constexpr float kWideDistance = 0.30f;
    static constexpr float kWideAngleDeg = 45.0f;
    float min_inlier_ratio = 0.75f;      ///< inliers of the final alignment, of the overlapping pixels
    float max_icp_rmse = 0.035f;         ///< RMS point-to-plane residual, metres
    float max_photometric_rmse = 0.10f;  ///< RMS intensity residual, 0..1
    /// Of live and model intensities, where both have contrast (-1..1): rejects another place of the same shape, and
    /// does not depend on the exposure.
    static constexpr float kMinCorrelation = 0.9f;
    float max_translation_sigma = 0.005f;  ///< standard deviation of the pose in its least certain direction, metres
    float max_rotation_sigma = 0.005f;     ///< likewise, radians
    /// From the proposed pose, metres (rotation: radians); further away the alignment has found another minimum.
    static constexpr float kMaxCorrection = 1.0f;
};

struct LoopConfig {
    bool enabled = true;
    int time_window = 200;  ///< surfels not seen for so many frames are the inactive model (ElasticFusion)
    int interval = 5;       ///< a loop is looked for every so many frames
    /// Inactive surfels in view, per pixel, from which on a local loop is tried; with fewer the overlap cannot suffice.
    static constexpr float kMinInactive = 0.05f;
    /// Share of the image that must show the inactive model: near the present pose, where drift is small ...
    static constexpr float kMinOverlap = 0.10f;
    /// ... and at a keyframe that only place recognition has proposed.
    static constexpr float kMinOverlapElsewhere = 0.30f;
    /// A loop is closed at once when this share of the image fits. With less it waits for a better view, until the
    /// overlap no longer grows ...
    static constexpr float kAmpleOverlap = 0.75f;
    int patience = 30;  ///< ... or, for an overlap below kMinOverlapElsewhere, until so many frames have gone by
    float min_discrepancy =
        0.004f;              ///< mean displacement below which the map is not deformed, only re-activated, metres
    float max_drift = 0.2f;  ///< what a loop corrects can be drift up to so many metres per metre travelled since ...
    float max_drift_at_rest = 0.3f;  ///< ... and so many metres more; beyond, two places look alike
    /// A keyframe that did not fit is not tried again for so many frames: the view hardly changes before.
    static constexpr int kRetryAfter = 20;
    int relative_constraints = 8;  ///< kept from each loop for the later ones
    FernConfig ferns;
};

struct RelocalisationConfig {
    bool enabled = true;
    int lost_after = 10;  ///< frames without tracking until the camera counts as lost (ElasticFusion)
    /// Inliers, of the live pixels, that tracking needs to go on after a failure: more than min_inlier_ratio, as the
    /// pose it starts from may be wrong.
    static constexpr float kRecoverInlierRatio = 0.6f;
    /// Share of the image that must show the model; less than for loops, as a second frame has to confirm the pose.
    static constexpr float kMinOverlap = 0.15f;
    int proposals = 4;  ///< similar keyframes that are tried, one a frame, between two tries at the last pose
    /// A keyframe that did not fit is not tried again for so many frames, so that others have their turn.
    static constexpr int kRetryAfter = 10;
};

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
