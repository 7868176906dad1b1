#pragma once
#include "engine/loops/aligner.hpp"
#include "engine/loops/back_end_state.hpp"
#include "engine/loops/fern_database.hpp"
#include "engine/loops/loop_attempt.hpp"

namespace posefusion {

/// Recovers the pose after tracking has failed. One proposal is tried per frame, in turn: the one from outside
/// (features, say; TrackedFrame::proposal), where there is one, on every other frame; the keyframes most similar to the
/// live image and, between them, the last known pose. A keyframe that does not fit is blocked for a while. A pose is
/// accepted when the next frame confirms it close by.
class Relocaliser {
public:
    /// @param tracking  limits on the camera's motion between two frames  @param localise_only  the map is not changed
    Relocaliser(const RelocalisationConfig& config, const TrackingConfig& tracking, bool localise_only);

    void count_failure() { ++state_.failures; }
    void count_success() { state_.failures = 0, state_.found.reset(); }
    /// Consecutive frames on which tracking has failed, up to now.
    [[nodiscard]] int failures() const { return state_.failures; }
    [[nodiscard]] bool lost() const { return state_.failures >= config_.lost_after; }
    /// The camera may be anywhere: place recognition has to find it.
    void lose_camera();

    /// One attempt, on a frame on which tracking has failed. Acceptance resets the count of failures.
    [[nodiscard]] LoopAttempt find_camera(const TrackedFrame& frame, const FernCode& code, FernDatabase& places,
                                          Aligner& aligner);

    [[nodiscard]] const RelocalisationState& state() const { return state_; }
    void restore(const RelocalisationState& state) { state_ = state; }

private:
    /// The keyframe to try on this frame; nullptr: try the last known pose.
    [[nodiscard]] Keyframe* next_proposal(std::uint32_t frame, const FernCode& code, FernDatabase& places);
    [[nodiscard]] bool is_one_step(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) const;

    RelocalisationConfig config_;
    bool localise_only_;
    double max_translation_, max_rotation_;  ///< of a camera between two frames, metres and radians
    RelocalisationState state_;
};

}  // namespace posefusion
