#pragma once
/// Configuration of place recognition, loop closing and relocalisation.
namespace posefusion {

/// Place recognition. Values from ElasticFusion unless noted otherwise.
struct FernConfig {
    int ferns = 500;    ///< number of ferns (binary tests) that encode a view
    unsigned seed = 1;  ///< of the random ferns; the same seed gives the same results
    /// Views are coded at 1 / kShrink of the image size: small enough that noise and texture do not decide.
    static constexpr int kShrink = 8;
    float keyframe_dissimilarity =
        0.3f;  ///< a view that differs from all keyframes in more than this share of its ferns becomes a keyframe
    float query_similarity =
        0.5f;  ///< least share of equal ferns of a proposal (ours: proposals are verified, but not for free)
    /// Share of the ferns that must have depth: a view with less (a person in front of the camera) would look like any
    /// other of its kind.
    static constexpr float kMinGood = 0.3f;
};

/// When a live image counts as the same place as the model it was aligned with. Used for loops and relocalisation.
struct AlignmentConfig {
    /// The coarse alignment starts from a pose with drift or from a keyframe's: wider gates than in tracking, for
    /// associated points (metres) and their normals (degrees).
    static constexpr float kWideDistance = 0.30f;
    static constexpr float kWideAngleDeg = 45.0f;
    float min_inlier_ratio = 0.75f;      ///< least share of inliers of the fine alignment among the overlapping pixels
    float max_icp_rmse = 0.035f;         ///< RMS point-to-plane residual, metres
    float max_photometric_rmse = 0.10f;  ///< RMS intensity residual, 0..1
    /// Of live and model intensities, where both have contrast (-1..1): rejects another place of the same shape, and
    /// does not depend on the exposure.
    static constexpr float kMinCorrelation = 0.9f;
    /// Standard deviation of the pose in its least certain direction, metres (rotation: radians): a loop must be more
    /// certain than the drift that it corrects.
    static constexpr float kMaxTranslationSigma = 0.005f;
    static constexpr float kMaxRotationSigma = 0.005f;
    /// Distance from the proposed pose, metres (rotation: radians): farther away, the alignment has found another
    /// minimum.
    static constexpr float kMaxCorrection = 1.0f;
};

struct LoopConfig {
    bool enabled = true;
    int time_window = 200;  ///< surfels not seen for this many frames are the inactive model (ElasticFusion)
    int interval = 5;       ///< a loop is searched for every n-th frame
    /// Inactive surfels in view, per pixel, from which on a local loop is tried; with fewer the overlap cannot suffice.
    static constexpr float kMinInactive = 0.05f;
    /// Share of the image that must show the inactive model: near the present pose, where drift is small ...
    static constexpr float kMinOverlap = 0.10f;
    /// ... and at a keyframe that only place recognition has proposed.
    static constexpr float kMinOverlapElsewhere = 0.30f;
    /// A loop is closed at once when this share of the image fits. With less it waits for a better view, until the
    /// overlap no longer grows ...
    static constexpr float kAmpleOverlap = 0.75f;
    int patience = 30;  ///< ... or, for an overlap below kMinOverlapElsewhere, until this many frames have gone by
    float min_discrepancy =
        0.004f;  ///< mean displacement below which the map is not deformed, only reactivated, metres
    float max_drift =
        0.2f;  ///< the correction of a loop is plausible up to this many metres per metre travelled since ...
    float max_drift_at_rest = 0.3f;  ///< ... plus this many metres; beyond, it is another place that looks alike
    /// A keyframe that did not fit is not tried again for this many frames: the view hardly changes before.
    static constexpr int kRetryAfter = 20;
    int relative_constraints = 8;  ///< kept from each loop for the later ones
    FernConfig ferns;
};

struct DeformationConfig {
    float node_spacing = 0.4f;  ///< between neighbouring nodes, metres
    int temporal_window = 40;   ///< frames: a surface not seen for up to this long still counts as the same, and each
                                ///< further such interval separates nodes like a distance of node_spacing
    int neighbours = 4;         ///< earlier nodes that each node is tied to
    /// Frames between the cameras that become nodes: drift between them is small enough to be interpolated linearly.
    static constexpr int kCameraInterval = 10;
    // Only the ratios of the weights matter. They are balanced so that a loop deforms trajectory and map together and
    // spreads its correction over the whole loop; tools/benchmark_loops measures it.
    /// Weight of the ties between successive cameras and between a camera and the map nodes it saw first, per m^2 and
    /// rad^2, where tracking is as certain as in the median; elsewhere scaled with its certainty, by direction.
    static constexpr float kOdometryWeight = 6e3f;
    /// Weight of the tie between cameras that see the same surfaces: multiplied by the share of common surfaces,
    /// divided by the number of cameras between them.
    static constexpr float kCovisibilityWeight = 200;
    static constexpr float kRotationWeight = 0.02f;  ///< weight of the difference of neighbours' rotations, per rad^2
    /// Weight of the distance between a node and the position its neighbour predicts, per m^2.
    static constexpr float kRegularisationWeight = 0.2f;
    float constraint_weight = 1e4f;  ///< weight of a constraint's distance, per m^2
    /// Standard deviation of a step between two frames that tracking says nothing about, metres ...
    static constexpr float kStepTranslationSigma = 0.05f;
    static constexpr float kStepRotationSigma = 0.05f;  ///< ... and radians
    /// Errors of neighbouring pixels are correlated: this many pixels count as one independent measurement.
    float correlated_pixels = 100;
    int iterations = 20;  ///< maximum number of Gauss-Newton steps; a solution that needs more is rejected
    /// The solution has converged when no node moves (m) or rotates (rad) by more than this in a step: far below the
    /// resolution of the map.
    static constexpr float kConvergedStep = 1e-4f;
    /// Mean distance of the constraints, metres: if it is smaller beforehand, there is nothing to correct; if it is
    /// larger afterwards, the solution is rejected. The alignments that make the constraints are not more certain
    /// (AlignmentConfig::kMaxTranslationSigma).
    static constexpr float kMaxConstraintError = 0.005f;
    /// A solution that separates two neighbouring nodes by more than this is rejected, metres: as much as a loop may
    /// correct, since all of the drift can stem from one place.
    float max_edge_error = 2;
};

struct RelocalisationConfig {
    bool enabled = true;
    int lost_after = 10;  ///< failed frames until the camera counts as lost (ElasticFusion)
    /// Least share of inliers among the live pixels with which tracking resumes after a failure: larger than
    /// min_inlier_ratio, as the initial pose may be wrong.
    static constexpr float kRecoverInlierRatio = 0.6f;
    /// Share of the image that must show the model; less than for loops, as a second frame has to confirm the pose.
    static constexpr float kMinOverlap = 0.15f;
    int proposals = 4;  ///< similar keyframes that are tried, one per frame, between two attempts at the last pose
    /// A keyframe that did not fit is not tried again for this many frames, so that others are tried as well.
    static constexpr int kRetryAfter = 10;
};

}  // namespace posefusion
