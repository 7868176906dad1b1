#pragma once
/// Every number of the dense SLAM engine, with unit, default and source. The shaders get them from here.
namespace posefusion {

struct PreprocessConfig {
    float depth_min = 0.3f;       ///< nearest depth used, metres
    float depth_max = 5.0f;       ///< farthest depth used, metres
    int bilateral_radius = 2;     ///< window radius, pixels
    float bilateral_space = 1.5f; ///< standard deviation, pixels
    float bilateral_range = 3.0f; ///< standard deviation, in standard deviations of the depth noise at that depth
    int normal_radius = 3;        ///< window radius of the plane fit, pixels at half resolution
    int mask_dilation = 4;        ///< person masks grow by this before tracking and fusion, pixels at 640 wide
};

/// Standard deviation of one depth measurement: a + b (z - c)^2 metres (Nguyen, Izadi & Lovell 2012, for Kinect).
struct DepthNoise {
    float a = 0.0012f;       ///< metres
    float b = 0.0019f;       ///< 1/metres
    float c = 0.4f;          ///< metres
    float lateral = 0.8f;    ///< pixels (same source)
    float floor = 0.001f;    ///< metres, calibration error that no averaging removes
};

struct TrackingConfig {
    int iterations[3] = {10, 5, 4};       ///< most Gauss-Newton steps at full, half and quarter resolution
    int full_resolution_step = 2;         ///< at full resolution every 2nd pixel (chequerboard) or every pixel (1) is used
    int so3_iterations = 10;              ///< most steps of the rotation-only pre-alignment; 0 turns it off
    bool icp = true;                      ///< geometric term on
    bool photometric = true;              ///< photometric term on
    float icp_max_distance = 0.10f;       ///< between associated points, metres
    float icp_max_angle_deg = 30.0f;      ///< between associated normals, degrees
    float icp_robust = 2.0f;              ///< Cauchy scale of the geometric residual, standard deviations
    float photometric_weight = 8.0f;      ///< of the photometric term; depth noise is correlated over several pixels, so that a
                                          ///< depth pixel tells less than its variance says
    float photometric_robust = 2.0f;      ///< Cauchy scale of the photometric residual, standard deviations
    float min_gradient = 0.01f;           ///< pixels with less texture have no photometric residual, intensity (0..1) per pixel
    float converged_translation = 1e-4f;  ///< a level ends when a step moves less, metres ...
    float converged_rotation = 5e-5f;     ///< ... and rotates less, radians
    float min_inlier_ratio = 0.2f;        ///< of the live pixels with static depth; fewer: tracking has failed, the pose is held
    float max_translation = 0.3f;         ///< metres per frame; more is implausible: tracking has failed
    float max_rotation_deg = 30.0f;       ///< degrees per frame, likewise
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
    float free_space_margin = 0.04f;      ///< static depth behind a surfel by this much proves it is not there, metres ...
    float free_space_sigmas = 4.0f;       ///< ... or by so many standard deviations, whichever is more
    float free_space_decay = 0.6f;        ///< factor on the confidence of such a surfel, per frame
    float speed_scale = 0.05f;            ///< metres or radians per frame from which on fusion weighs half
    unsigned initial_capacity = 1u << 20; ///< surfels
    unsigned max_capacity = 8u << 20;     ///< surfels; a map that needs more ends the run with an error that says so
};

struct SlamConfig {
    PreprocessConfig preprocess;
    DepthNoise noise;
    TrackingConfig tracking;
    MapConfig map;
    bool int64_atomics = true;  ///< use 64-bit atomics where the device has them (false: the two-pass fallback)
    bool validation = false;    ///< run with Vulkan's core and synchronization validation (slow; for tests)
};

}  // namespace posefusion
