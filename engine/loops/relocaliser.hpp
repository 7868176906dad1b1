#pragma once
#include "engine/loops/aligner.hpp"
#include "engine/loops/back_end_state.hpp"
#include "engine/loops/fern_database.hpp"
#include "engine/loops/loop_attempt.hpp"

namespace posefusion {

/// Finds the camera again after tracking has failed. One proposal is tried per frame, in turn: the keyframes that look
/// most like the live image, and between them where the camera was last. A keyframe that does not fit is left out for a
/// while. A pose that fits is believed when the next frame fits close to it, too.
class Relocaliser {
public:
    /// @param tracking  how far a camera may move from one frame to the next  @param localise_only  the map stays as it
    /// is
    Relocaliser(const RelocalisationConfig& config, const TrackingConfig& tracking, bool localise_only);

    void count_failure() { ++state_.failures; }
    void count_success() { state_.failures = 0, state_.found.reset(); }
    /// Consecutive frames without tracking up to now.
    [[nodiscard]] int failures() const { return state_.failures; }
    [[nodiscard]] bool lost() const { return state_.failures >= config_.lost_after; }
    /// The camera may be anywhere: place recognition has to find it.
    void lose_camera();

    /// One attempt, on a frame on which tracking has failed. If it is accepted nothing counts as failed any more.
    [[nodiscard]] LoopAttempt find_camera(const TrackedFrame& frame, const FernCode& code, FernDatabase& places,
                                          Aligner& aligner);

    [[nodiscard]] const RelocalisationState& state() const { return state_; }
    void restore(const RelocalisationState& state) { state_ = state; }

private:
    /// The keyframe to try on this frame; nullptr: where the camera was last.
    [[nodiscard]] Keyframe* next_proposal(std::uint32_t frame, const FernCode& code, FernDatabase& places);
    [[nodiscard]] bool is_one_step(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) const;

    RelocalisationConfig config_;
    bool localise_only_;
    double max_translation_, max_rotation_;  ///< of a camera between two frames, metres and radians
    RelocalisationState state_;
};

}  // namespace posefusion
