#include "engine/loops/loop_closer.hpp"

#include <algorithm>

#include "engine/core/median.hpp"
#include "engine/core/stopwatch.hpp"

namespace posefusion {

namespace {

std::uint32_t median_created(const std::vector<gpu::LoopSample>& samples) {
    std::vector<std::uint32_t> created;
    for (const auto& sample : samples) {
        if (sample.valid) created.push_back(sample.created);
    }
    return created.empty() ? 0 : upper_median(created);
}

}  // namespace

LoopCloser::LoopCloser(vulkan::Context& context, const Intrinsics& camera, const LoopConfig& config,
                       const DeformationConfig& deformation)
    : config_(config),
      least_inactive_(LoopConfig::kMinInactive * static_cast<float>(camera.width * camera.height)),
      correction_(context, config, deformation) {}

std::vector<LoopAttempt> LoopCloser::close_loop(const TrackedFrame& frame, const FernCode& code, FernDatabase& places,
                                                Aligner& aligner, std::vector<GraphCamera>& trajectory) {
    const std::uint32_t now = frame.number(), active_since = frame.params.active_since;
    std::vector<LoopAttempt> attempts;
    if (active_since == 0 || now % static_cast<std::uint32_t>(config_.interval) != 0) return attempts;

    const auto attempt = [&](LoopKind kind, const Eigen::Isometry3d& proposal, std::uint32_t keyframe) {
        const Stopwatch watch;
        const float least = kind == LoopKind::Local ? LoopConfig::kMinOverlap : LoopConfig::kMinOverlapElsewhere;
        const Alignment alignment = aligner.align(frame, ModelPart::Inactive, least, proposal);
        LoopEvent event = event_of(kind, now, alignment);
        event.model_frame = kind == LoopKind::Local ? median_created(alignment.samples) : keyframe;
        if (alignment.accepted && !view_is_best(alignment.overlap, now)) {
            event.accepted = false;
            event.reason = "waiting for a better view";
        }
        if (event.accepted)
            event.accepted = correction_.correct(frame, alignment, trajectory, places.keyframes(), event);
        if (event.accepted) aligner.reactivate(frame, active_since);
        event.milliseconds = watch.milliseconds();
        attempts.push_back({event, alignment.T_world_camera});
        return event.accepted;
    };

    const bool sees_inactive = static_cast<float>(frame.inactive_in_view) >= least_inactive_;
    if (sees_inactive && attempt(LoopKind::Local, frame.T_world_camera, 0)) return attempts;
    const std::vector<FernMatch> matches = places.query(code, 1, now, active_since);
    if (matches.empty()) return attempts;
    Keyframe& keyframe = places.keyframes()[matches[0].keyframe];
    if (!attempt(LoopKind::Global, keyframe.T_world_camera, keyframe.frame))
        keyframe.blocked_until = now + static_cast<std::uint32_t>(LoopConfig::kRetryAfter);
    return attempts;
}

bool LoopCloser::view_is_best(float overlap, std::uint32_t frame) {
    const bool is_pending =
        pending_.overlap > 0 && frame - pending_.last_seen <= static_cast<std::uint32_t>(2 * config_.interval);
    const bool grows = !is_pending || overlap > pending_.overlap;
    if (!is_pending) pending_.since = frame;
    pending_.overlap = overlap;
    pending_.last_seen = frame;
    const bool patient = frame - pending_.since < static_cast<std::uint32_t>(config_.patience);
    const bool fair = overlap >= LoopConfig::kMinOverlapElsewhere;
    return overlap >= LoopConfig::kAmpleOverlap || (fair && !grows) || !patient;
}

void LoopCloser::restore(const PendingLoop& pending, const std::vector<LoopConstraint>& relative_constraints) {
    pending_ = pending;
    correction_.restore(relative_constraints);
}

}  // namespace posefusion
