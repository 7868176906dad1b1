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
    int iterations[3] = {10, 5, 4};   ///< most Gauss-Newton steps at full, half and quarter resolution
    int full_resolution_step = 2;     ///< at full resolution every 2nd pixel (chequerboard) or every pixel (1) is used
    int so3_iterations = 10;          ///< most steps of the rotation-only pre-alignment; 0 turns it off
    bool icp = true;                  ///< geometric term on
    bool photometric = true;          ///< photometric term on
    float icp_max_distance = 0.10f;   ///< between associated points, metres
    float icp_max_angle_deg = 30.0f;  ///< between associated normals, degrees
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
    int index_map_scale = 2;              ///< cells per pixel and axis: 2 = 4x super-sampled
    float association_depth = 0.05f;      ///< between a pixel and its surfel along the ray, metres (ElasticFusion) ...
    float association_sigmas = 3.0f;      ///< ... or so many standard deviations of the depth noise, whichever is more
    float association_angle_deg = 30.0f;  ///< between the normals, degrees
    float stable_confidence = 10.0f;      ///< a surfel is stable from this confidence on (ElasticFusion)
    float predict_confidence = 1.5f;      ///< surfels below this are not part of the predicted model
    float max_weight = 100.0f;            ///< of a surfel's running means, observations at 1 m
    int unstable_timeout = 20;            ///< unstable surfels not seen for so many frames are removed (ElasticFusion)
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
    int shrink = 8;     ///< views are coded at 1 / shrink of the image size
    float keyframe_dissimilarity =
        0.3f;  ///< a view that differs from all keyframes in more than this share of its ferns is a new one
    float query_similarity =
        0.5f;  ///< least share of equal ferns of a proposal (ours: proposals are verified, but not for free)
    float min_good = 0.3f;  ///< share of the ferns that must have depth for a view to be coded at all
};

/// When is a live image the same place as the model it was aligned to? Used for loops and for relocalisation.
struct AlignmentConfig {
    float wide_distance = 0.30f;           ///< between associated points in the first, rough alignment, metres
    float wide_angle_deg = 45.0f;          ///< between associated normals there, degrees
    float min_inlier_ratio = 0.75f;        ///< inliers of the final alignment, of the overlapping pixels
    float max_icp_rmse = 0.035f;           ///< RMS point-to-plane residual, metres
    float max_photometric_rmse = 0.10f;    ///< RMS intensity residual, 0..1
    float min_correlation = 0.9f;          ///< of live and model intensities, where both have contrast (-1..1)
    float max_translation_sigma = 0.005f;  ///< standard deviation of the pose in its least certain direction, metres
    float max_rotation_sigma = 0.005f;     ///< likewise, radians
    float max_correction = 1.0f;           ///< from the proposed pose, metres (rotation: radians)
};

struct LoopConfig {
    bool enabled = true;
    int time_window = 200;       ///< surfels not seen for so many frames are the inactive model (ElasticFusion)
    int interval = 5;            ///< a loop is looked for every so many frames
    float min_inactive = 0.05f;  ///< inactive surfels in view, per pixel, from which on a local loop is tried
    float min_overlap = 0.10f;   ///< share of the image that must show the older model, near the present pose ...
    float min_overlap_elsewhere = 0.30f;  ///< ... and at a keyframe that place recognition has proposed
    float ample_overlap = 0.75f;  ///< a loop is closed at once when so much of the image fits; with less the camera is
                                  ///< waited for to see more, until the overlap no longer grows
    int patience = 30;  ///< ... or, for an overlap below min_overlap_elsewhere, until so many frames have gone by
    float min_discrepancy =
        0.004f;              ///< mean displacement below which the map is not deformed, only re-activated, metres
    float max_drift = 0.2f;  ///< what a loop corrects can be drift up to so many metres per metre travelled since ...
    float max_drift_at_rest = 0.3f;  ///< ... and so many metres more; beyond, two places look alike
    int retry_after = 20;            ///< a keyframe that turned out not to fit is not tried again for so many frames
    int relative_constraints = 8;    ///< kept from each loop for the later ones
    FernConfig ferns;
};

struct RelocalisationConfig {
    bool enabled = true;
    int lost_after = 10;  ///< frames without tracking until the camera counts as lost (ElasticFusion)
    float recover_inlier_ratio =
        0.6f;                   ///< after a failure tracking needs so many inliers, of the live pixels, to go on
    float min_overlap = 0.15f;  ///< share of the image that must show the model
    int proposals = 4;          ///< similar keyframes that are tried, one a frame, between two tries at the last pose
    int retry_after = 10;       ///< a keyframe that did not fit is not tried again for so many frames
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
