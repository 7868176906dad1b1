#pragma once
#include "engine/preprocess/preprocessing.hpp"
#include "engine/tracking/tracker_state.hpp"
#include "engine/tracking/tracking_config.hpp"

namespace posefusion {

/// Copies the tracking configuration into the kernels' parameters.
void set_params(gpu::Params& params, const TrackingConfig& config);
/// Where the image does not fix how far the camera moves, the motion of the frame before goes on.
/// @param params  `interval` is set
void expect_steady_motion(gpu::Params& params);

/// Before the first frame: camera at the world's origin, nothing failed, full weight.
[[nodiscard]] gpu::TrackingRecord first_record();

/// Frame-to-model tracking, wholly on the device: SO(3) pre-alignment to the previous live image, then point-to-plane
/// ICP plus the photometric term, coarse to fine. The pose and everything known about it end in `record`.
class Tracker {
public:
    /// @param rolling  rows were taken at different times: the motion during read-out is estimated with the pose
    Tracker(vulkan::Context& context, const Intrinsics& camera, const TrackingConfig& config, bool rolling = false);
    /// @param live   this frame;  @param model  prediction at the last pose
    /// @param start  gpu::StartRecord: where the camera may be, too; nullptr: there is never such a start
    void enqueue_frame(vulkan::Sequence& sequence, const vulkan::Buffer& params, const ImagePyramid& live,
                       const ImagePyramid& model, const vulkan::Buffer* start = nullptr) const;
    /// Copies the live image for the next frame's pre-alignment.
    void enqueue_keep_live(vulkan::Sequence& sequence, const ImagePyramid& live) const;

    /// The state that the next frame is tracked against. @param model  as passed to enqueue_frame()
    /// @param model_color  of the same prediction, as passed to Exposure::enqueue(). Waits for the device.
    [[nodiscard]] TrackerState state(const ImagePyramid& model, const vulkan::Buffer& model_color) const;
    /// The state of a tracker before its first frame.
    [[nodiscard]] TrackerState first_state(const ImagePyramid& model, const vulkan::Buffer& model_color) const;
    /// Whether a state has the sizes of this camera's images.
    [[nodiscard]] bool fits(const TrackerState& state, const ImagePyramid& model,
                            const vulkan::Buffer& model_color) const;
    /// The state must have passed fits().
    void restore(const TrackerState& state, const ImagePyramid& model, const vulkan::Buffer& model_color);

    vulkan::Buffer record;  ///< gpu::TrackingRecord

private:
    static constexpr int kSo3Level = 2;

    /// Where the turn at the stamp is estimated with the pose: the rows of half resolution are enough.
    static constexpr int kTurnLevel = 1;
    /// Each step finds half of what is left or more: pose and turn look alike, and far pixels count little at first.
    static constexpr int kTurnSteps = 3;

    vulkan::Context& context_;
    Intrinsics camera_;
    TrackingConfig config_;
    bool rolling_;
    vulkan::Buffer previous_;  ///< live image of the previous frame: [pixels_at(camera, 2)] (intensity, gradient)
    vulkan::Buffer rows_, row_counts_, arguments_;
    vulkan::Kernel begin_, so3_reduce_, so3_solve_, choose_start_, reduce_, solve_, turn_reduce_, turn_solve_, end_;
};

}  // namespace posefusion
