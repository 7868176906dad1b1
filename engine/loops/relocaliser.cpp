#include "engine/loops/relocaliser.hpp"

#include <algorithm>

#include "engine/core/angle.hpp"
#include "engine/core/stopwatch.hpp"

namespace posefusion {

Relocaliser::Relocaliser(const RelocalisationConfig& config, const TrackingConfig& tracking, bool localise_only)
    : config_(config),
      localise_only_(localise_only),
      max_translation_(static_cast<double>(tracking.max_translation)),
      max_rotation_(radians(static_cast<double>(tracking.max_rotation_deg))) {}

void Relocaliser::lose_camera() {
    state_.failures = std::max(state_.failures, std::max(1, config_.lost_after));
    state_.found.reset();
    state_.proposal = 0;
}

LoopAttempt Relocaliser::find_camera(const TrackedFrame& frame, const FernCode& code, FernDatabase& places,
                                     Aligner& aligner) {
    const Stopwatch watch;
    const bool confirming = state_.found.has_value();
    const bool from_outside = !confirming && frame.proposal && frame.number() % 2 == 0;
    Keyframe* keyframe = confirming || from_outside ? nullptr : next_proposal(frame.number(), code, places);
    const Eigen::Isometry3d proposal = confirming     ? *state_.found
                                       : from_outside ? frame.proposal->T_world_camera
                                       : keyframe     ? keyframe->T_world_camera
                                                      : frame.T_world_camera;
    const Alignment alignment = aligner.align(frame, ModelPart::Whole, RelocalisationConfig::kMinOverlap, proposal);
    if (keyframe && !alignment.accepted)
        keyframe->blocked_until = frame.number() + static_cast<std::uint32_t>(RelocalisationConfig::kRetryAfter);

    LoopAttempt attempt{event_of(LoopKind::Relocalisation, frame.number(), alignment), alignment.T_world_camera};
    attempt.event.model_frame = from_outside ? frame.proposal->frame : keyframe ? keyframe->frame : frame.number();
    state_.found.reset();
    if (alignment.accepted && !(confirming && is_one_step(proposal, alignment.T_world_camera))) {
        attempt.event.accepted = false;
        attempt.event.reason = "to be confirmed by the next frame";
        state_.found = alignment.T_world_camera;
    }
    if (attempt.event.accepted) {
        state_.failures = 0;
        if (!localise_only_) aligner.reactivate(frame, frame.number());  // all that is in view becomes active
    }
    attempt.event.milliseconds = watch.milliseconds();
    return attempt;
}

Keyframe* Relocaliser::next_proposal(std::uint32_t frame, const FernCode& code, FernDatabase& places) {
    if (state_.proposal++ % (1 + static_cast<std::uint32_t>(config_.proposals)) == 0) return nullptr;
    const auto matches = places.query(code, 1, frame, frame);
    return matches.empty() ? nullptr : &places.keyframes()[matches[0].keyframe];
}

/// Whether a camera can move like this from one frame to the next.
bool Relocaliser::is_one_step(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to) const {
    const Eigen::Isometry3d step = from.inverse() * to;
    return step.translation().norm() <= max_translation_ && Eigen::AngleAxisd(step.linear()).angle() <= max_rotation_;
}

}  // namespace posefusion
