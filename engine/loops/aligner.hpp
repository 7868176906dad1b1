#pragma once
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "engine/map/surfel_map.hpp"
#include "engine/tracking/tracker.hpp"
#include "engine/vulkan/shared_types.hpp"

namespace posefusion {

enum class ModelPart {
    Inactive,  ///< what was last seen before the time window
    Whole,     ///< everything
};

/// A live image brought into agreement with the model, or the reason why not.
struct Alignment {
    Eigen::Isometry3d T_world_camera = Eigen::Isometry3d::Identity();
    bool accepted = false;
    std::string reason;      ///< empty where accepted
    float overlap = 0;       ///< share of the image in which both live depth and the model show something
    float inlier_ratio = 0;  ///< of the overlap
    float icp_rmse_m = 0, photometric_rmse = 0;
    float correlation = 0;                 ///< of live and model intensities, -1..1
    std::vector<gpu::LoopSample> samples;  ///< kLoopGridWidth * kLoopGridHeight
};

/// How alike live image and model look where their surfaces agree, whatever the exposure: correlation of the
/// intensities, -1..1; 1 where there are too few samples, or too little contrast, to say.
[[nodiscard]] float correlation_of(std::span<const gpu::LoopSample> samples);

/// Does the live image show this place of the model, and where exactly is the camera? Model and live image are aligned
/// twice, roughly from the proposed pose and finely from what came out, by the tracker that also follows the camera.
class Aligner {
public:
    Aligner(vulkan::Context& context, const Intrinsics& camera, const SlamConfig& config);

    /// @param now  parameters of the current frame  @param min_overlap  share of the image that must show the model
    [[nodiscard]] Alignment align(const gpu::Params& now, ModelPart part, float min_overlap,
                                  const Eigen::Isometry3d& T_world_camera, const Preprocessing& frame,
                                  const PyramidBuilder& pyramids, const SurfelMap& map);
    /// Makes the inactive surfels that the last alignment saw active, at its pose.
    void reactivate(const gpu::Params& now, SurfelMap& map);
    /// The surfel buffers have changed: what was recorded with them is recorded again.
    void forget_recording() { align_sequence_.reset(), reactivate_sequence_.reset(); }

private:
    void set_params(const gpu::Params& now, ModelPart part);
    void enqueue(vulkan::Sequence& sequence, const Preprocessing& frame, const PyramidBuilder& pyramids,
                 const SurfelMap& map) const;
    void judge(Alignment& alignment, float min_overlap, const Eigen::Isometry3d& proposed) const;

    vulkan::Context& context_;
    Intrinsics camera_;
    AlignmentConfig config_;
    Tracker tracker_;
    ImagePyramid model_;
    vulkan::Buffer model_color_, wide_params_, fine_params_, host_record_, samples_, host_samples_;
    std::unique_ptr<vulkan::Sequence> align_sequence_, reactivate_sequence_;
};

}  // namespace posefusion
