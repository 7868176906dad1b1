#pragma once
namespace posefusion {

struct TrackingConfig {
    int iterations[3] = {10, 5, 4};  ///< most Gauss-Newton steps at full, half and quarter resolution
    int full_resolution_step = 2;    ///< at full resolution every 2nd pixel (chequerboard) or every pixel (1) is used
    int so3_iterations = 10;         ///< most steps of the rotation-only pre-alignment; 0 turns it off
    bool icp = true;                 ///< geometric term on
    bool photometric = true;         ///< photometric term on
    float icp_max_distance = 0.10f;  ///< largest distance between associated points, metres
    /// Largest angle between associated normals, degrees: normals of one surface agree this well despite noise, those
    /// across an edge do not.
    static constexpr float kIcpMaxAngleDeg = 30.0f;
    float icp_robust = 2.0f;          ///< Cauchy scale of the geometric residual, standard deviations
    float photometric_weight = 8.0f;  ///< weight of the photometric term; depth noise is correlated over several
                                      ///< pixels, so that a depth pixel tells less than its variance says
    /// Cauchy scale of the photometric residual, standard deviations.
    static constexpr float kPhotometricRobust = 2.0f;
    /// What the image does not fix, as along a bare wall, goes on as before, give or take what a hand does: standard
    /// deviation of the camera's acceleration, m/s^2.
    static constexpr float kAcceleration = 4;
    /// ... and with at least this weight, relative to what the image says of a shift on average: noise and errors of
    /// depth make a bare wall look as if it fixed the camera sideways, too.
    static constexpr float kSteadyShare = 0.05f;
    /// A direction counts as fixed from this share of the average on.
    static constexpr float kSteadyEnough = 0.1f;
    float min_gradient = 0.01f;  ///< pixels with less texture have no photometric residual, intensity (0..1) per pixel
    /// A level ends when a step translates (metres) and rotates (radians) less: below the noise of a pose.
    static constexpr float kConvergedTranslation = 1e-4f;
    static constexpr float kConvergedRotation = 5e-5f;
    float min_inlier_ratio = 0.35f;  ///< least share of inliers among live pixels with static depth; with fewer
                                     ///< tracking fails and the pose is held
    float max_icp_rmse = 0.06f;      ///< RMS point-to-plane residual; more: tracking has failed, metres
    float max_translation_sigma =
        0.02f;  ///< standard deviation of the pose along an axis; more: tracking has failed, metres
    float max_rotation_sigma = 0.02f;  ///< likewise about an axis, radians
    float max_translation = 0.3f;      ///< metres per frame; more is implausible: tracking has failed
    float max_rotation_deg = 30.0f;    ///< degrees per frame, likewise
};

}  // namespace posefusion
