#pragma once
#include "engine/preprocess/preprocessing.hpp"

namespace posefusion {

/// Frame-to-model tracking, wholly on the device: SO(3) pre-alignment to the previous live image, then point-to-plane
/// ICP plus the photometric term, coarse to fine. The pose and everything known about it end in `record`.
class Tracker {
public:
    Tracker(vulkan::Context& context, const Intrinsics& camera, const TrackingConfig& config);
    /// @param live   this frame;  @param model  prediction at the last pose
    void record_frame(vulkan::Sequence& sequence, const vulkan::Buffer& params, const ImagePyramid& live, const ImagePyramid& model) const {
        record_tracking(sequence, params, live, model, previous_);
    }
    /// The same with the rotation-only pre-alignment to the model, where Params::rotation_first says so: of a live image that
    /// is no successor of the one before, or of one that was taken elsewhere.
    void record_alignment(vulkan::Sequence& sequence, const vulkan::Buffer& params, const ImagePyramid& live, const ImagePyramid& model) const {
        record_tracking(sequence, params, live, model, model.photometric[kSo3Level]);
    }
    /// Keeps the live image for the next frame's pre-alignment.
    void record_keep_live(vulkan::Sequence& sequence, const ImagePyramid& live) const;

    /// What record_keep_live() keeps: [pixels_at(camera, 2)] (intensity, gradient).
    [[nodiscard]] const vulkan::Buffer& previous_live() const { return previous_; }

    vulkan::Buffer record;  ///< gpu::TrackingRecord

private:
    static constexpr int kSo3Level = 2;

    /// @param turned_from  what the rotation-only pre-alignment aligns to, like previous_live()
    void record_tracking(vulkan::Sequence& sequence, const vulkan::Buffer& params, const ImagePyramid& live, const ImagePyramid& model,
                         const vulkan::Buffer& turned_from) const;

    Intrinsics camera_;
    TrackingConfig config_;
    vulkan::Buffer previous_, rows_, row_counts_, arguments_;
    vulkan::Kernel begin_, so3_reduce_, so3_solve_, reduce_, solve_, end_;
};

}  // namespace posefusion
