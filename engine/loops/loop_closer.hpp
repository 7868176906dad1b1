#pragma once
#include <vector>

#include "engine/loops/aligner.hpp"
#include "engine/loops/back_end_state.hpp"
#include "engine/loops/loop_attempt.hpp"
#include "engine/loops/loop_correction.hpp"

namespace posefusion {

/// Detects places that the camera has returned to: the inactive model near the current pose (local loop), and the
/// keyframe most similar to the live image (global loop).
class LoopCloser {
public:
    LoopCloser(vulkan::Context& context, const Intrinsics& camera, const LoopConfig& config,
               const DeformationConfig& deformation);

    /// Closes at most one loop, on a frame that has been tracked. @param trajectory  of all frames, this one the last
    /// @return the attempts; only the last can be accepted
    [[nodiscard]] std::vector<LoopAttempt> close_loop(const TrackedFrame& frame, const FernCode& code,
                                                      FernDatabase& places, Aligner& aligner,
                                                      std::vector<GraphCamera>& trajectory);
    /// Forgets pending loops: the camera may be anywhere from now on.
    void lose_camera() { pending_.overlap = 0; }

    /// LoopCorrection::follow()
    void follow(const SurfelMap& map, std::span<const Eigen::Isometry3d> poses, std::vector<GraphCamera>& trajectory,
                std::vector<Keyframe>& keyframes) {
        correction_.follow(map, poses, trajectory, keyframes);
    }

    [[nodiscard]] const LoopCorrection& correction() const { return correction_; }
    [[nodiscard]] const PendingLoop& pending() const { return pending_; }
    void restore(const PendingLoop& pending, const std::vector<LoopConstraint>& relative_constraints);

private:
    /// Whether the view of a possible loop has stopped improving.
    [[nodiscard]] bool view_is_best(float overlap, std::uint32_t frame);

    LoopConfig config_;
    float least_inactive_;  ///< inactive surfels in view from which on a local loop is tried
    LoopCorrection correction_;
    PendingLoop pending_;
};

}  // namespace posefusion
