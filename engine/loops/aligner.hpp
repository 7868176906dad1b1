#pragma once
#include <memory>

#include "engine/loops/alignment.hpp"
#include "engine/loops/tracked_frame.hpp"
#include "engine/tracking/tracker.hpp"

namespace posefusion {

enum class ModelPart {
    Inactive,  ///< surfels last seen before the time window
    Whole,     ///< all surfels
};

/// Aligns the live image with the model: does it show this place, and where exactly is the camera? Two passes of the
/// frame-to-model tracker: a coarse one from the proposed pose, a fine one from the result.
class Aligner {
public:
    /// @param tracking  the configuration of frame-to-model tracking
    Aligner(vulkan::Context& context, const Intrinsics& camera, const AlignmentConfig& config,
            const TrackingConfig& tracking);

    /// @param min_overlap  share of the image that must show the model  @param T_world_camera  the proposed pose
    [[nodiscard]] Alignment align(const TrackedFrame& frame, ModelPart part, float min_overlap,
                                  const Eigen::Isometry3d& T_world_camera);
    /// Reactivates the inactive surfels that the last alignment saw from its pose; active surfels that duplicate them
    /// are removed. @param active_since  surfels last seen before this frame are inactive
    void reactivate(const TrackedFrame& frame, std::uint32_t active_since);
    /// Call after the surfel buffers have changed: command sequences that use them are recorded again.
    void forget_recordings() { align_sequence_.reset(), reactivate_sequence_.reset(); }

private:
    void set_params(const gpu::Params& now, ModelPart part);
    void enqueue(vulkan::Sequence& sequence, const TrackedFrame& frame) const;

    vulkan::Context& context_;
    AlignmentConfig config_;
    Tracker tracker_;
    ImagePyramid model_;
    vulkan::Buffer model_color_, wide_params_, fine_params_, host_record_, samples_, host_samples_;
    vulkan::Kernel loop_samples_, reactivate_;
    std::unique_ptr<vulkan::Sequence> align_sequence_, reactivate_sequence_;
};

}  // namespace posefusion
