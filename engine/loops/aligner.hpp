#pragma once
#include <memory>

#include "engine/loops/alignment.hpp"
#include "engine/loops/tracked_frame.hpp"
#include "engine/tracking/tracker.hpp"

namespace posefusion {

enum class ModelPart {
    Inactive,  ///< what was last seen before the time window
    Whole,     ///< everything
};

/// Does the live image show this place of the model, and where exactly is the camera? Model and live image are aligned
/// twice, roughly from the proposed pose and finely from what came out, by the tracker that also follows the camera.
class Aligner {
public:
    /// @param tracking  as the camera is followed
    Aligner(vulkan::Context& context, const Intrinsics& camera, const AlignmentConfig& config,
            const TrackingConfig& tracking);

    /// @param min_overlap  share of the image that must show the model  @param T_world_camera  proposed
    [[nodiscard]] Alignment align(const TrackedFrame& frame, ModelPart part, float min_overlap,
                                  const Eigen::Isometry3d& T_world_camera);
    /// Makes the inactive surfels that the last alignment saw active, at its pose; what the active model has laid over
    /// them is removed. @param active_since  surfels last seen before this frame are inactive
    void reactivate(const TrackedFrame& frame, std::uint32_t active_since);
    /// The surfel buffers have changed: what was recorded with them is recorded again.
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
