#pragma once
#include "engine/preprocess/preprocessing.hpp"

namespace posefusion {

/// Frame-to-model tracking, wholly on the device: SO(3) pre-alignment to the previous live image, then point-to-plane
/// ICP plus the photometric term, coarse to fine. The pose and everything known about it end in `record`.
class Tracker {
public:
    Tracker(vulkan::Context& context, const Intrinsics& camera, const TrackingConfig& config);
    /// @param live   this frame;  @param model  prediction at the last pose
    void enqueue_frame(vulkan::Sequence& sequence, const vulkan::Buffer& params, const ImagePyramid& live,
                       const ImagePyramid& model) const;
    /// Keeps the live image for the next frame's pre-alignment.
    void enqueue_keep_live(vulkan::Sequence& sequence, const ImagePyramid& live) const;

    /// What enqueue_keep_live() keeps: [pixels_at(camera, 2)] (intensity, gradient).
    [[nodiscard]] const vulkan::Buffer& previous_live() const { return previous_; }

    vulkan::Buffer record;  ///< gpu::TrackingRecord

private:
    static constexpr int kSo3Level = 2;

    Intrinsics camera_;
    TrackingConfig config_;
    vulkan::Buffer previous_, rows_, row_counts_, arguments_;
    vulkan::Kernel begin_, so3_reduce_, so3_solve_, reduce_, solve_, end_;
};

}  // namespace posefusion
